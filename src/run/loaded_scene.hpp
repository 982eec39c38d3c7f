// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "geometry/search/scene_tree.hpp"
#include "scene/scene.hpp"
#include "scene/tiled_scene.hpp"

namespace tubefoot {

class FacetNumbering;
class SurfaceMesh;
class OmittedRelief;
class RayScene;
class RefinedSurfaceFile;

/// How relief is in a scene's facets; nothing of it without relief.
struct SceneRelief {
  double cell_m = 0;                                ///< 0: no relief
  std::size_t base_facets = 0, uniform_facets = 0;  ///< unrefined; textured ones in cells
  std::vector<FacetId> parent;  ///< offline: by facet of the scene, the unrefined one; of a part, the part's
  std::shared_ptr<const OmittedRelief> omitted;
  // Of a tiled site, offline, whose tiles are refined when they are loaded:
  std::uint64_t parts_a_facet = 1;                 ///< into how many facets one may be cut, about
  std::shared_ptr<const RefinedSurfaceFile> file;  ///< that they come from; null: they are made
};

/// What was made of a loaded scene's facets that no sonar tells apart (coarsening.hpp). Bounds of the map
/// from the facets given onto those there are.
struct SceneCoarsening {
  double tolerance = 0;  ///< asked for, of what is resolved
  std::size_t facets_before = 0, facets = 0;
  double largest_move_m = 0;    ///< of a point
  double largest_share = 0;     ///< of what is resolved where it is moved
  double largest_turn_rad = 0;  ///< of the direction that a point of the surface faces
  double rms_turn_rad = 0;      ///< of what was turned at all, by area
  double seconds = 0;
};

/// What was loaded of terrain that is read by tiles.
struct TerrainUse {
  std::atomic<std::size_t> regions{0}, loads{0};  ///< regions that pings are grouped into; loaded, also again
  std::atomic<std::size_t> most_bytes{0};         ///< held at a time
};

/// A loaded scene, ready for pings: relief is in its facets or ready to be refined for each transmission, and
/// the facets are in a tree. open_survey() and survey_with_tiles() build sites; to all others they are const.
/// Where terrain is read by tiles (scene.tiled), the scene's mesh has all but that.
struct LoadedScene {
  explicit LoadedScene(Scene loaded);
  ~LoadedScene();
  LoadedScene(const LoadedScene&) = delete;  // tree and ground point into the scene
  LoadedScene& operator=(const LoadedScene&) = delete;

  Scene scene;
  SceneRelief relief;
  std::unique_ptr<const SurfaceMesh>
      surface_mesh;  ///< relief online: what transmissions refine, each for itself
  std::unique_ptr<const SceneTree> tree;
  bool is_cut = false;           ///< by the sea surface, above which no facet is
  std::size_t facets_given = 0;  ///< before planes were merged; 0: they were not
  std::optional<SceneCoarsening> coarsening;
  double lowest_m = 0;  ///< of the scene, where water refracts: rays do not turn below
  double load_seconds = 0, tree_seconds = 0;
  std::shared_ptr<TerrainUse> terrain_use;  ///< null without tiles
  // Of what survey_with_tiles() makes:
  std::shared_ptr<const LoadedScene> whole;  ///< the tiled site that this is a part of
  TileChoice tiles;                          ///< its tiles that the mesh has

  bool is_tiled() const { return !scene.tiled.empty(); }
  /// Whether relief gets into facets as tiles are loaded.
  bool refines_tiles() const { return is_tiled() && relief.cell_m > 0 && surface_mesh == nullptr; }
  /// Whether each transmission meets facets of its own.
  bool has_surface_per_transmission() const { return surface_mesh != nullptr || scene.water->refracts(); }
  /// The number that a facet of the mesh has where all of the scene is in memory. Thread-safe. Throws as
  /// FacetNumbering().
  FacetId number_of(FacetId facet) const;
  /// Of the facet, before relief, that a facet is part of.
  FacetId base_number_of(FacetId facet) const;
  /// Of a tiled site. Thread-safe.
  const FacetNumbering& numbering() const;
  /// Of its facets before relief. Thread-safe.
  const FacetNumbering& base_numbering() const;
  /// The mesh's vertices in metres, worked out at the first call. Thread-safe.
  const std::vector<glm::dvec3>& vertices_m() const;
  /// The facets made ready for rays, at the first call. Thread-safe. Throws as RayScene().
  const RayScene& rays() const;

 private:
  mutable std::once_flag rays_made_, vertices_made_, numbered_, numbering_made_, base_numbered_,
      base_numbering_made_;
  mutable std::unique_ptr<const RayScene> rays_;
  mutable std::vector<glm::dvec3> vertices_m_;
  mutable std::vector<FacetId> numbers_, base_numbers_;  ///< of a part, by facet; by facet before relief
  mutable std::unique_ptr<const FacetNumbering> numbering_, base_numbering_;  ///< of a tiled site
};

}  // namespace tubefoot
