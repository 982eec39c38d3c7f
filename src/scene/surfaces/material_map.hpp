// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec2.hpp>
#include <limits>
#include <vector>

#include "geometry/mesh/plan_cut.hpp"
#include "scene/description/material_description.hpp"
#include "scene/description/scene_component.hpp"
#include "scene/description/terrain_description.hpp"
#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// A segment of a material map's borders, in metres of the local frame in plan view. It bounds one or two
/// regions.
struct MaterialBorder {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  glm::dvec2 a, b;
  std::uint32_t region = 0, other_region = none;
};

/// Material as a function of position. Regions have a material and borders. A position lies in a region if
/// a ray from it crosses the region's borders an odd number of times. Inner rings are therefore holes. The
/// region with the largest number counts where several contain a position. Outside of all regions the
/// default material counts.
class MaterialMap {
 public:
  MaterialMap(std::vector<MaterialBorder> borders, std::vector<std::uint16_t> material_of_region,
              std::uint16_t default_material);

  const std::vector<MaterialBorder>& borders() const { return borders_; }
  /// Returns the index of the material at a position. On a border the result is the material of either
  /// side.
  std::uint16_t at(glm::dvec2 place_m) const;

 private:
  std::size_t row(double y) const;

  std::vector<MaterialBorder> borders_;
  std::vector<std::uint16_t> material_of_region_;
  std::uint16_t default_material_;
  // Borders by the west-east strips that they reach.
  double lo_y_ = 0, hi_y_ = 0;
  std::vector<std::uint32_t> first_, list_;
};

/// Largest number of border segments and of patches per map.
inline constexpr std::size_t most_material_borders = 2'000'000, most_material_patches = 200'000;

/// A terrain's map, created once and applied to parts of the terrain.
class TerrainMap {
 public:
  /// `terrain` has a map; `lo_m` and `hi_m` bound all of the terrain. Throws InputError.
  TerrainMap(const TerrainDescription& terrain, const std::vector<MaterialDescription>& materials,
             const LocalFrame& frame, glm::dvec3 lo_m, glm::dvec3 hi_m);

  /// Divides facets along the borders and assigns a material (an index into the materials) to each part.
  /// Returns the original facet of each part. The division of a facet does not depend on the others.
  /// Thread-safe. Throws InputError.
  std::vector<std::uint32_t> apply(ComponentMesh& mesh) const;

 private:
  SourcePlace place_;
  MaterialMap map_;
  std::vector<PlanSegment> segments_;  ///< borders, each once
};

/// Divides a terrain's facets along the borders of its map and assigns a material (an index into
/// `materials`) to each part. Without a map it does nothing. Returns the number of divided facets. Throws
/// InputError.
std::size_t apply_material_map(ComponentMesh& mesh, const TerrainDescription& terrain,
                               const std::vector<MaterialDescription>& materials, const LocalFrame& frame);

}  // namespace tubefoot
