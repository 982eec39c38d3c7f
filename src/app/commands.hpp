// SPDX-License-Identifier: GPL-3.0-or-later
// Options of each command, as the command line sets them, and the functions that execute the commands. Each
// function prints to stdout and returns the exit code.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "exchange/readers/kmall_scene.hpp"
#include "import/import_options.hpp"
#include "run/options.hpp"

namespace tubefoot {

/// Options of join: the scene, the output, and the format of the results. All other settings are those of
/// the shards.
struct JoinOptions : RunOptions {
  bool keep_parts = false;
};

struct CheckOptions : CommonOptions {
  std::optional<std::filesystem::path> picture;  ///< picture of the scene to write
};

struct AuditOptions : CommonOptions {
  std::optional<std::string> sensor;
  std::string pings = ":";
};

struct FootprintOptions : CommonOptions {
  std::string sensor;
  std::string pings = "0";
  std::string beams;  ///< in the format of resolved_beams(); empty: all
  std::filesystem::path output;
  std::optional<std::filesystem::path> rationals;  ///< file of exact corners
};

struct CoverageOptions : CommonOptions {
  std::optional<std::string> sensor;
  std::optional<int> order;  ///< largest order of paths, as in [paths]; none: that of the scene
  std::string pings = ":";
  std::filesystem::path output;
  std::optional<std::filesystem::path> picture;
};

/// Options of `strength`, which needs a mesh only. Ranges have the format of angles_of() and
/// frequencies_of().
struct StrengthOptions {
  std::filesystem::path mesh, output;
  std::string azimuths = "0:359:1", elevations = "0", frequencies, reflection = "rigid";
  double sound_speed = 1500, roughness_m = 0;
  bool reference = false;
  double tolerance = 1e-3;  ///< tolerance of the reference
  std::optional<std::filesystem::path> compared;
  std::optional<double> unit_m;
  std::optional<std::string> up;
  std::optional<int> threads;
  bool quiet = false;
};

/// Options of `rays`: the water is that of a scene or of a profile. Lists have the format of lengths_of() and
/// angles_of().
struct RaysOptions : CommonOptions {
  std::optional<std::filesystem::path> profile;  ///< table of sound speeds, instead of a scene
  std::optional<std::string> sensor, from;       ///< the source: a sensor, or a position
  std::string pings = "0";
  std::vector<std::string> to;  ///< positions, or tables of positions
  std::string ranges, depths, angles;
  std::optional<double> bottom_m, frequency_khz;
  std::optional<int> reflections;
  int turns = 16;
  std::optional<std::filesystem::path> output, picture, environment;
};

/// `scene` is a scene file or the folder of a run.
struct ViewOptions : CommonOptions {
  std::optional<std::filesystem::path> moved_scene;  ///< present path of the scene of a result folder
  std::optional<std::string> sensor, pings;
  /// Echo file whose picture is compared with that of the view.
  std::optional<std::filesystem::path> candidate;
  /// Echo file that replaces the picture of the view in this comparison.
  std::optional<std::filesystem::path> reference;
  std::filesystem::path output;
};

struct RefineOptions : CommonOptions {
  std::filesystem::path output;
};

struct ExportOptions : CommonOptions {
  std::string to;  ///< a format of exchange_format()
  std::optional<std::string> sensor;
  std::int64_t ping = 0;
  std::filesystem::path output;
};

/// `world` is an SDF file, a Stonefish scenario, or a survey line of a Kongsberg sonar.
struct ImportSceneOptions {
  std::filesystem::path world, output;
  KmallSceneOptions kmall;                        ///< for survey lines only
  std::vector<std::filesystem::path> model_path;  ///< folders that model:// refers to
  std::optional<double> unit_m;                   ///< unit of meshes that state none
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
  std::string fit;  ///< combination of gain, range and offset; empty: none
  bool geometry = false;
  /// Energy above which a bin of the candidate is insonified; for `geometry`.
  std::optional<double> threshold;
  std::size_t frames = 1;  ///< number of consecutive pings of the candidate that are averaged
  bool diagnose = false;
  std::optional<std::string> ideal;  ///< sampling of a perfect engine, or an echo file of such an engine
  std::optional<std::filesystem::path> scene;  ///< scene from which the reference was computed
  bool attribute = false;                      ///< attribute the error to objects and facets
  bool confined = false, quiet = false;        ///< as in CommonOptions, for the scene
  /// Output model file that converts the reference to the units of the candidate.
  std::optional<std::filesystem::path> output_model;
  std::optional<std::filesystem::path> html;  ///< page with all results and a diagnosis
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

struct KeysOptions {
  std::optional<std::string> name;  ///< section, kind or key
  bool json = false;
};

/// The benchmark suite (docs/reference-results.md).
struct SuiteOptions {
  std::filesystem::path output;
  std::optional<std::string> seed;  ///< seed of a validation set; none: the debug set
  std::string scenes;               ///< names separated by commas; empty: all
  std::optional<int> version;       ///< none: the newest
  bool without_answers = false;
  std::optional<int> threads;
  bool quiet = false;
};

// Each command prints to stdout and returns the exit code. It throws InputError for invalid input,
// UsageError for an invalid command line, and std::exception if the run fails.
int run_command(const RunOptions& options);
int join_command(const JoinOptions& options);
int check_command(const CheckOptions& options);
int audit_command(const AuditOptions& options);
int footprints_command(const FootprintOptions& options);
int coverage_command(const CoverageOptions& options);
int strength_command(const StrengthOptions& options);
int rays_command(const RaysOptions& options);

int view_command(const ViewOptions& options);
int refine_command(const RefineOptions& options);
int export_command(const ExportOptions& options);
int import_scene_command(const ImportSceneOptions& options);
int presets_command(const PresetsOptions& options);
int keys_command(const KeysOptions& options);
int chart_command(const ChartOptions& options);
int advise_command(const AdviseOptions& options);
int suite_command(const SuiteOptions& options);
/// Returns 3 if the error of the candidate exceeds the limit of the options.
int compare_command(const CompareOptions& options);
int import_command(const ImportOptions& options);

}  // namespace tubefoot
