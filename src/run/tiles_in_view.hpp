// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "geometry/search/scene_tree.hpp"
#include "run/survey.hpp"
#include "scene/tiled_scene.hpp"

namespace tubefoot {

/// Which tiles of a survey's terrain a ping may have to do with: all whose facets could be candidates of a
/// tube, carry relief that a shot refines, or be met by its paths. With only these in the mesh, a ping
/// computes what it would with all of them, to the last bit (docs/big-terrain.md says why).
class TilesInView {
 public:
  /// The survey, whose sensors may still be missing for below(), outlives this.
  explicit TilesInView(const Survey& survey);

  TileChoice of(const SharedShots& group, std::size_t ping) const;
  /// Those with facets above or below a place, before or after relief moves them.
  TileChoice below(glm::dvec3 place_m) const;
  std::uint64_t facets(const TileChoice& choice) const;

 private:
  /// Tiles as facets with the same boxes, so that what asks for facets finds tiles.
  struct Boxes {
    std::size_t component;
    std::vector<std::uint32_t> tile;  ///< by facet
    FacetMesh mesh, columns;          ///< columns: however high and low
    std::unique_ptr<SceneTree> tree, column_tree;
  };
  void add(const Boxes& boxes, const std::vector<FacetId>& found, TileChoice& choice) const;
  void finish(TileChoice& choice) const;

  const Survey& survey_;
  double lift_m_;  ///< of relief, and the grid's rounding
  std::vector<Boxes> boxes_;
};

/// A survey that one ping can be seen in: the survey itself, or, where terrain is read by tiles, one with
/// those that the ping needs.
std::shared_ptr<const Survey> survey_around(const Survey& survey, const SharedShots& group, std::size_t ping);

}  // namespace tubefoot
