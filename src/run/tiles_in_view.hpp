// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "geometry/search/scene_tree.hpp"
#include "run/transmission.hpp"
#include "scene/tiled_scene.hpp"

namespace tubefoot {

/// Which tiles of a loaded scene's terrain a ping may have to do with: all whose facets could be candidates
/// of a tube, carry relief that a transmission refines, or be met by its paths. With only these in the mesh,
/// a ping computes what it would with all of them, to the last bit (docs/big-terrain.md says why).
class TilesInView {
 public:
  /// The site outlives this.
  explicit TilesInView(const LoadedScene& loaded_scene);

  /// Of a ping of a group of these transmissions, which are of this site.
  TileChoice of(const Transmissions& transmissions, const SharedTransmissions& group, std::size_t ping) const;
  /// The components in the mesh, of which the ping may have to do with a facet.
  std::vector<std::size_t> components_of(const Transmissions& transmissions, const SharedTransmissions& group,
                                         std::size_t ping) const;
  /// Those with facets that come into a box.
  TileChoice within(glm::dvec3 lo_m, glm::dvec3 hi_m) const;
  /// Those with facets above or below a place, before or after relief moves them.
  TileChoice below(glm::dvec3 place_m) const;
  /// In their tiles; about so many where relief is refined with them.
  std::uint64_t facets(const TileChoice& choice) const;

 private:
  /// Tiles as facets with the same boxes, so that what asks for facets finds tiles.
  struct Boxes {
    std::size_t component;
    std::vector<std::uint32_t> tile;  ///< by facet
    FacetMesh mesh, columns;          ///< columns: however high and low
    std::unique_ptr<SceneTree> tree, column_tree;

    void add(std::uint32_t number, const WorldGrid& grid, glm::dvec3 lo_m, glm::dvec3 hi_m);
    void add_to(TileChoice& choice, const std::vector<FacetId>& found) const;
  };
  TileChoice looked_at(std::span<const Boxes> list, const Transmissions& transmissions,
                       const SharedTransmissions& group, std::size_t ping) const;
  void finish(TileChoice& choice) const;

  const LoadedScene& loaded_scene_;
  double lift_m_;  ///< of relief, and the grid's rounding
  std::vector<Boxes> boxes_;
  std::vector<Boxes> rest_;  ///< of the components that are not tiled, one each
};

/// A survey that one ping can be seen in: the transmissions' own, or, where terrain is read by tiles, one
/// with those that the ping needs.
Survey survey_around(const Transmissions& transmissions, const SharedTransmissions& group, std::size_t ping);

/// Calls `look` with scenes that have the tiles between them that come into a box, a row of tiles at a time,
/// and all that is not tiled each; not at all for a survey that is not tiled.
void for_tiles_within(const Survey& survey, glm::dvec3 lo_m, glm::dvec3 hi_m,
                      const std::function<void(const Scene&)>& look);

/// A survey's transmissions, for who asks ping by ping: where terrain is read by tiles, those of
/// survey_around().
class TransmissionsAround {
 public:
  /// The transmissions outlive this.
  explicit TransmissionsAround(const Transmissions& transmissions);
  /// Transmissions of the survey that this ping can be seen in, which live until another ping is asked for.
  /// Throws InputError for a raster that can no longer be read.
  const Transmissions& at(const SharedTransmissions& group, std::size_t ping);

 private:
  const Transmissions& transmissions_;
  std::optional<TilesInView> view_;
  TileChoice tiles_;
  std::unique_ptr<const Transmissions> part_;
};

}  // namespace tubefoot
