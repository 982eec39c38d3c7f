// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/shot_ground.hpp"
#include "engine/history.hpp"
#include "scene/scene.hpp"

namespace tubefoot {

/// A vector file of footprints: one feature each, a MULTIPOLYGON Z of its convex pieces in the local frame
/// (east, north, up in metres), with its measures as attributes. Through refracting water, corners, centroid
/// and area are true ones; solid angle, grazing angle and ranges are those of the apparent facet. The ending
/// chooses the format: .gpkg, .geojson, .csv (WKT).
class FootprintFile {
 public:
  /// Will write to `file`, at close(); with relief, a footprint's facet is one of its shot's ground, and the
  /// scene's own facet is named too, as base_facet. Throws UsageError for an unknown ending,
  /// std::runtime_error with GDAL's message if the file cannot be made.
  explicit FootprintFile(const std::filesystem::path& file, bool with_relief = false);
  ~FootprintFile();

  /// `beam_of_tube` as in Sensor. Throws std::runtime_error where writing fails.
  void add(const Scene& scene, const ShotGround& ground, const History& history,
           const std::vector<std::uint32_t>& beam_of_tube, std::size_t ping);
  /// Finishes the file; throws std::runtime_error where that fails.
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tubefoot
