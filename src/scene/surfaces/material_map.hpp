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

/// A piece of a material map's borders, in metres of the local frame seen from above: it bounds one region or
/// two.
struct MaterialBorder {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  glm::dvec2 a, b;
  std::uint32_t region = 0, other_region = none;
};

/// Material as a function of place: regions, each with its material and the borders about it. A place lies in
/// a region if a ray from it crosses the region's borders an odd number of times (so inner rings are holes);
/// of several regions that hold a place the one with the greatest number counts, of none the default.
class MaterialMap {
 public:
  MaterialMap(std::vector<MaterialBorder> borders, std::vector<std::uint16_t> material_of_region,
              std::uint16_t default_material);

  const std::vector<MaterialBorder>& borders() const { return borders_; }
  /// Index of the material at a place. On a border, either side's.
  std::uint16_t at(glm::dvec2 place_m) const;

 private:
  std::size_t row(double y) const;

  std::vector<MaterialBorder> borders_;
  std::vector<std::uint16_t> material_of_region_;
  std::uint16_t default_material_;
  // Borders by the strips from west to east that they reach into.
  double lo_y_ = 0, hi_y_ = 0;
  std::vector<std::uint32_t> first_, list_;
};

/// At most so many pieces of borders a map, patches a map.
inline constexpr std::size_t most_material_borders = 2'000'000, most_material_patches = 200'000;

/// A terrain's map, made once to be put on parts of the terrain.
class TerrainMap {
 public:
  /// Of a terrain with a map; `lo_m` and `hi_m` are about all of it. Throws InputError.
  TerrainMap(const TerrainDescription& terrain, const std::vector<MaterialDescription>& materials,
             const LocalFrame& frame, glm::dvec3 lo_m, glm::dvec3 hi_m);

  /// Puts facets, cut along the borders, each into its material (an index into the materials). Returns the
  /// facet that each then is a part of; what a facet is cut into does not depend on the others. Thread-safe.
  /// Throws InputError.
  std::vector<std::uint32_t> apply(ComponentMesh& mesh) const;

 private:
  SourcePlace place_;
  MaterialMap map_;
  std::vector<PlanSegment> segments_;  ///< its borders, each once
};

/// Puts a terrain's facets, cut along the borders of its map, each into its material (an index into
/// `materials`). Nothing happens without a map. Returns how many facets were cut. Throws InputError.
std::size_t apply_material_map(ComponentMesh& mesh, const TerrainDescription& terrain,
                               const std::vector<MaterialDescription>& materials, const LocalFrame& frame);

}  // namespace tubefoot
