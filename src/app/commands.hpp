// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "import/import_options.hpp"
#include "run/options.hpp"

namespace tubefoot {

/// Of a run in parts: its scene, its output, and how results are written. All else is what the parts were
/// asked for.
struct JoinOptions : RunOptions {
  bool keep_parts = false;
};

struct CheckOptions : CommonOptions {
  std::optional<std::filesystem::path> picture;  ///< of the scene
};

struct AuditOptions : CommonOptions {
  std::optional<std::string> sensor;
  std::string pings = ":";
};

struct FootprintOptions : CommonOptions {
  std::string sensor;
  std::string pings = "0";
  std::string beams;  ///< as resolved_beams() reads them; empty: all
  std::filesystem::path output;
  std::optional<std::filesystem::path> rationals;  ///< exact corners as well
};

struct CoverageOptions : CommonOptions {
  std::optional<std::string> sensor;
  std::optional<int> order;  ///< of [paths]; none: the scene's
  std::string pings = ":";
  std::filesystem::path output;
  std::optional<std::filesystem::path> picture;
};

/// Of a mesh by itself. Ranges as angles_of() and frequencies_of() read them.
struct StrengthOptions {
  std::filesystem::path mesh, output;
  std::string azimuths = "0:359:1", elevations = "0", frequencies, reflection = "rigid";
  double sound_speed = 1500, roughness_m = 0;
  bool reference = false;
  double tolerance = 1e-3;  ///< of the reference
  std::optional<double> unit_m;
  std::optional<std::string> up;
  std::optional<int> threads;
  bool quiet = false;
};

/// `scene` is a scene file or a folder that a run wrote.
struct ViewOptions : CommonOptions {
  std::optional<std::filesystem::path> moved_scene;  ///< where the scene of a result folder is now
  std::optional<std::string> sensor, pings;
  std::optional<std::filesystem::path> candidate;  ///< echo file whose picture is held against the view's
  std::optional<std::filesystem::path> reference;  ///< and in the place of that
  std::filesystem::path output;
};

struct RefineOptions : CommonOptions {
  std::filesystem::path output;
};

struct ExportOptions : CommonOptions {
  std::string to;  ///< as exchange_format() reads it
  std::optional<std::string> sensor;
  std::int64_t ping = 0;
  std::filesystem::path output;
};

/// `world` is an SDF file or a Stonefish scenario.
struct ImportSceneOptions {
  std::filesystem::path world, output;
  std::vector<std::filesystem::path> model_path;  ///< folders of model://
  bool quiet = false;
};

struct CompareOptions {
  std::filesystem::path reference, candidate;
  std::optional<std::string> json;  ///< file, or "-" for stdout
  std::optional<std::filesystem::path> png;
  std::optional<std::string> sensor;
  std::size_t worst = 5;
  bool any_scene = false;
  std::optional<double> within_l1, within_db;
  std::string fit;  ///< of gain, range and offset; empty: none
  bool geometry = false;
  std::optional<double> threshold;  ///< above it, the candidate is lit; for geometry
  std::size_t frames = 1;           ///< pings of the candidate that are averaged
  bool diagnose = false;
  std::optional<std::string> ideal;                   ///< sampling of a perfect engine, or the file of one
  std::optional<std::filesystem::path> scene;         ///< that the reference was computed of
  bool attribute = false;                             ///< say whose the error is
  bool confined = false, quiet = false;               ///< as CommonOptions, of the scene
  std::optional<std::filesystem::path> output_model;  ///< puts the truth into the candidate's measure
  std::optional<std::filesystem::path> html;          ///< page of it all, with a diagnosis
};

struct ChartOptions {
  std::vector<std::filesystem::path> scenes;
  std::filesystem::path output;
  std::optional<std::string> pings;  ///< as resolved() reads them; none: the first
  int repeats = 3;
  double seconds_per_trial = 4;
  bool confined = false;
  bool quiet = false;
};

struct AdviseOptions {
  std::filesystem::path scene;
  std::string tolerance;
  std::optional<std::string> pings;  ///< of each sensor, as resolved() reads them; none: all
  std::size_t trial_pings = 8;
  std::optional<int> threads;
  bool confined = false;
  std::optional<std::string> json;  ///< file, or "-" for stdout
  bool quiet = false;
};

struct PresetsOptions {
  std::optional<std::string> name;
};

/// The benchmark suite (docs/benchmark-suite.md).
struct SuiteOptions {
  std::filesystem::path output;
  std::optional<std::string> seed;  ///< of a validation set; none: the debug set
  std::string scenes;               ///< names between commas; empty: all
  bool without_answers = false;
  std::optional<int> threads;
  bool quiet = false;
};

// Each prints to stdout and returns the exit code. They throw InputError where the input is wrong, UsageError
// where the command line is, and std::exception where the run fails.
int run_command(const RunOptions& options);
int join_command(const JoinOptions& options);
int check_command(const CheckOptions& options);
int audit_command(const AuditOptions& options);
int footprints_command(const FootprintOptions& options);
int coverage_command(const CoverageOptions& options);
int strength_command(const StrengthOptions& options);

int view_command(const ViewOptions& options);
int refine_command(const RefineOptions& options);
int export_command(const ExportOptions& options);
int import_scene_command(const ImportSceneOptions& options);
int presets_command(const PresetsOptions& options);
int chart_command(const ChartOptions& options);
int advise_command(const AdviseOptions& options);
int suite_command(const SuiteOptions& options);
/// Returns 3 where the candidate is not within the error that the options allow.
int compare_command(const CompareOptions& options);
int import_command(const ImportOptions& options);

}  // namespace tubefoot
