// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "run/options.hpp"
#include "sensors/recordings/run_context.hpp"

namespace tubefoot {

struct SceneDescription;

/// Files that a run does not write, by request of the user (`--without`).
struct OmittedFiles {
  bool echoes = false, scene_picture = false;
  std::map<std::string, OmittedProducts> products;  ///< by name of the sensor
  std::vector<std::string> names;  ///< "echoes.nc", "fan-sonar.nc"; without numbers of pings and lines

  OmittedProducts of(const std::string& sensor) const {
    const auto found = products.find(sensor);
    return found == products.end() ? OmittedProducts() : found->second;
  }
};

/// Resolves the names of RunOptions::without: "echoes.nc", "scene.png", products of all sensors ("sonar.nc"),
/// and products of one sensor ("fan-sonar.nc"). Throws UsageError for an unknown name, with the known ones,
/// and for options whose results no file would contain.
OmittedFiles omitted_files(const SceneDescription& scene, const RunOptions& options);

}  // namespace tubefoot
