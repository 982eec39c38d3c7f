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

/// Finds the tiles of a loaded scene's terrain that a ping may need. These are all tiles whose facets could
/// be candidates of a tube, carry relief that a transmission refines, or be met by its paths. With these
/// tiles alone in the mesh, a ping has the same result as with all tiles, to the last bit
/// (docs/notes/visibility.md contains the reason).
class TilesInView {
 public:
  /// The loaded scene must outlive this object.
  explicit TilesInView(const LoadedScene& loaded_scene);
  TilesInView(const TilesInView&) = delete;
  TilesInView& operator=(const TilesInView&) = delete;

  /// Returns the tiles for a ping of a group. The transmissions must belong to this loaded scene.
  TileChoice of(const Transmissions& transmissions, const SharedTransmissions& group, std::size_t ping) const;
  /// Returns the components in the mesh of which the ping may need a facet. They contain all moving objects.
  std::vector<std::size_t> components_of(const Transmissions& transmissions, const SharedTransmissions& group,
                                         std::size_t ping) const;
  /// Returns the tiles with facets that meet a box.
  TileChoice within(glm::dvec3 lo_m, glm::dvec3 hi_m) const;
  /// Returns the tiles with facets above or below a position, before or after relief moves them.
  TileChoice below(glm::dvec3 place_m) const;
  /// Returns the number of facets in the tiles; approximate if relief is refined with them.
  std::uint64_t facets(const TileChoice& choice) const;

 private:
  /// Tiles as facets with the same bounding boxes, so that a search for facets finds tiles.
  struct Boxes {
    std::size_t component;
    std::vector<std::uint32_t> tile;  ///< by facet
    FacetMesh mesh, columns;          ///< columns: boxes of unlimited height
    std::unique_ptr<SceneTree> tree, column_tree;

    void add(std::uint32_t number, const WorldGrid& grid, glm::dvec3 lo_m, glm::dvec3 hi_m);
    void add_to(TileChoice& choice, const std::vector<FacetId>& found) const;
  };
  TileChoice looked_at(std::span<const Boxes> list, const Transmissions& transmissions,
                       const SharedTransmissions& group, std::size_t ping) const;
  void finish(TileChoice& choice) const;

  const LoadedScene& loaded_scene_;
  double lift_m_;  ///< largest relief, and the rounding of the grid
  std::vector<Boxes> boxes_;
  std::vector<Boxes> rest_;  ///< components without tiles, one each
};

/// Returns a survey with all facets that one ping may see. It is the survey of the transmissions, or, for
/// terrain that is read by tiles, a survey with the tiles that the ping needs.
Survey survey_around(const Transmissions& transmissions, const SharedTransmissions& group, std::size_t ping);

/// Calls `look` with scenes that together contain the tiles that meet a box, one row of tiles at a time.
/// Each scene also contains everything that is not tiled. Does nothing for a survey without tiles.
void for_tiles_within(const Survey& survey, glm::dvec3 lo_m, glm::dvec3 hi_m,
                      const std::function<void(const Scene&)>& look);

/// A survey's transmissions for callers that process single pings. If terrain is read by tiles, they belong
/// to survey_around().
class TransmissionsAround {
 public:
  /// The transmissions must outlive this object.
  explicit TransmissionsAround(const Transmissions& transmissions);
  /// Returns transmissions of a survey with all facets that this ping may see. They stay valid until another
  /// ping is requested. Throws InputError if a raster can no longer be read.
  const Transmissions& at(const SharedTransmissions& group, std::size_t ping);

 private:
  const Transmissions& transmissions_;
  std::optional<TilesInView> view_;
  TileChoice tiles_;
  std::unique_ptr<const Transmissions> part_;
};

}  // namespace tubefoot
