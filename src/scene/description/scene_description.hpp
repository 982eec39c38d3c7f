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
#include "scene/description/refinement_description.hpp"
#include "scene/description/run_description.hpp"
#include "scene/description/scatterers_description.hpp"
#include "scene/description/sensor_description.hpp"
#include "scene/description/terrain_description.hpp"
#include "scene/description/trajectory_description.hpp"
#include "scene/description/water_description.hpp"

// What a scene file says, key by key, in the file's own units (degrees, metres, kHz). Nothing is loaded yet.
// docs/scene-file.md documents every key with unit, default and range. Each section has a header of its own,
// to be included where no other is needed: this one changes with each of them.
namespace tubefoot {

struct SceneDescription {
  std::filesystem::path file;
  std::string sha256;  ///< of the scene file's text and of every file it names, in order: the scene hash
  /// What that hash is of, the scene file first, then every file that it names, with those that are read
  /// along.
  std::vector<std::filesystem::path> inputs;
  /// Those of them that lie outside of its folder, as messages; refused if it is `confined`.
  std::vector<std::string> outside;
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
  ScatterersDescription scatterers;
  RunDescription run;
};

/// Reads and checks a scene file: keys, types, ranges, names that refer to each other, files that must exist.
/// `kinds`: of its sensors (sensors/kinds/scene_file.hpp has all that there are). Throws InputError
/// "scene.toml:12:5: ..." that says what was expected. `confined`: what lies outside of the scene file's
/// folder, links followed, is refused; else it is noted.
SceneDescription read_scene_file(const std::filesystem::path& file, const SensorSections& kinds,
                                 bool confined = false);
/// The same from a text, as if it stood in `file`: relative paths start from that one's folder, and messages
/// name it. It need not exist.
SceneDescription read_scene_text(const std::string& text, const std::filesystem::path& file,
                                 const SensorSections& kinds, bool confined = false);

}  // namespace tubefoot
