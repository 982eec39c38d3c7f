// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scene/description/georeference_description.hpp"
#include "scene/description/material_description.hpp"
#include "scene/description/object_description.hpp"
#include "scene/description/paths_description.hpp"
#include "scene/description/processing_description.hpp"
#include "scene/description/refinement_description.hpp"
#include "scene/description/run_description.hpp"
#include "scene/description/scatterers_description.hpp"
#include "scene/description/sea_surface_description.hpp"
#include "scene/description/sensor_description.hpp"
#include "scene/description/terrain_description.hpp"
#include "scene/description/trajectory_description.hpp"
#include "scene/description/water_description.hpp"
#include "scene/description/water_targets_description.hpp"

// Description of a scene file, key by key, in the units of the file (degrees, metres, kHz). No further file
// is loaded. docs/scene-keys.md documents every key with unit, default and range.
// Each section has its own header. Include that header alone where possible, because this one changes with
// every section.
namespace tubefoot {

struct SceneDescription {
  std::filesystem::path file;
  std::string
      sha256;  ///< scene hash: SHA-256 of the scene file's text and of every file that it names, in order
  /// The hashed files: the scene file first, then every file that it names and its companions.
  std::vector<std::filesystem::path> inputs;
  /// Messages about deprecated keys, and about hashed files outside of the scene file's folder. Such files
  /// are an error if `confined`.
  std::vector<std::string> warnings;
  bool confined = false;
  std::string title;
  std::optional<GeoreferenceDescription> georeference;
  WaterDescription water;
  std::optional<SeaSurfaceDescription> sea_surface;
  PathsDescription paths;
  std::vector<MaterialDescription> materials;
  std::vector<TerrainDescription> terrains;
  std::vector<ObjectDescription> objects;
  std::vector<TrajectoryDescription> trajectories;
  std::vector<SensorDescription> sensors;
  RefinementDescription refinement;
  std::vector<WaterTargetDescription> targets;
  std::vector<TargetPopulationDescription> target_populations;
  ScatterersDescription scatterers;
  ProcessingDescription processing;
  RunDescription run;
};

/// Reads and checks a scene file: keys, types, ranges, references between names, and existence of files.
/// `kinds` are the kinds of sensors (sensors/kinds/scene_file.hpp has all of them).
/// If `confined`, files outside of the scene file's folder (links followed) are an error; otherwise they
/// are recorded. Throws InputError "scene.toml:12:5: ..." that states what was expected.
SceneDescription read_scene_file(const std::filesystem::path& file, const SensorSections& kinds,
                                 bool confined = false);
/// Reads a scene from a text as if it were in `file`. Relative paths start from the folder of `file`, and
/// messages name it. The file need not exist.
SceneDescription read_scene_text(const std::string& text, const std::filesystem::path& file,
                                 const SensorSections& kinds, bool confined = false);

}  // namespace tubefoot
