// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "geometry/search/scene_tree.hpp"
#include "run/moving_facets.hpp"
#include "scene/scene.hpp"
#include "scene/tiled_scene.hpp"

// This header declares the loaded scene: its facets on the grid, their search tree, and the state of relief,
// coarsening and terrain tiles.

namespace tubefoot {

class FacetNumbering;
class SurfaceMesh;
class OmittedRelief;
class RayScene;
class RefinedSurfaceFile;
struct WaterTargets;

/// State of the relief in the facets of a scene. All members keep their defaults without relief.
struct SceneRelief {
  double cell_m = 0;  ///< size of a relief cell, or 0 without relief
  /// number of facets before relief; number of facets if all textured facets were refined to cells
  std::size_t base_facets = 0, uniform_facets = 0;
  /// offline: by facet of the scene (or of a part of it), the facet before relief
  std::vector<FacetId> parent;
  std::shared_ptr<const OmittedRelief> omitted;
  // For a tiled scene, offline, whose tiles are refined when they are loaded:
  std::uint64_t parts_a_facet = 1;  ///< approximate largest number of facets that relief makes of one facet
  /// file with the refined facets; null if they are computed
  std::shared_ptr<const RefinedSurfaceFile> file;
};

/// Results of the coarsening of a loaded scene (coarsening.hpp). Bounds apply to the map from the given
/// facets to the coarse facets.
struct SceneCoarsening {
  double tolerance = 0;  ///< requested tolerance, relative to the resolved length
  std::size_t facets_before = 0, facets = 0;
  double largest_move_m = 0;    ///< largest displacement of a point
  double largest_share = 0;     ///< largest displacement relative to the resolved length at the same point
  double largest_turn_rad = 0;  ///< largest change of the surface normal
  double rms_turn_rad = 0;      ///< root mean square over the turned facets, weighted by area
  double seconds = 0;
};

/// Counts of loaded regions of terrain that is read by tiles.
struct TerrainUse {
  /// number of regions into which pings are grouped; number of loads, repeated ones included
  std::atomic<std::size_t> regions{0}, loads{0};
  std::atomic<std::size_t> most_bytes{0};  ///< largest number of bytes in memory at one time
};

/// A loaded scene, ready for pings. Relief is in its facets or ready to be refined for each transmission,
/// and the facets are in a tree. The functions open_survey() and survey_with_tiles() build loaded scenes;
/// all other code uses them as const. If terrain is read by tiles (scene.tiled), the scene's mesh contains
/// everything except that terrain.
struct LoadedScene {
  explicit LoadedScene(Scene loaded);
  ~LoadedScene();
  LoadedScene(const LoadedScene&) = delete;  // tree and surface mesh refer to the scene
  LoadedScene& operator=(const LoadedScene&) = delete;

  Scene scene;
  SceneRelief relief;
  std::unique_ptr<const FacetMesh> at_rest;  ///< base of `surface_mesh`, with moving objects
  std::unique_ptr<const SurfaceMesh>
      surface_mesh;  ///< relief online: the surface that each transmission refines for itself
  std::unique_ptr<const MovingFacets> moving;  ///< null without moving objects
  std::unique_ptr<const SceneTree> tree;
  bool is_cut = false;  ///< true if the sea surface has cut the facets, so that no facet lies above it
  std::size_t facets_given = 0;  ///< number of facets before planes were merged; 0 if they were not merged
  std::optional<SceneCoarsening> coarsening;
  double lowest_m = 0;  ///< lowest height of the scene, for refracting water: rays do not turn below it
  std::shared_ptr<const WaterTargets> targets;  ///< targets in the water; those of a part are its whole's
  double load_seconds = 0, tree_seconds = 0;
  std::shared_ptr<TerrainUse> terrain_use;  ///< null without tiles
  // For a part that survey_with_tiles() makes:
  std::shared_ptr<const LoadedScene> whole;  ///< the tiled scene to which this part belongs
  TileChoice tiles;                          ///< tiles of that scene that the mesh contains

  bool is_tiled() const { return !scene.tiled.empty(); }
  /// Returns whether relief refines the facets of tiles when they are loaded.
  bool refines_tiles() const { return is_tiled() && relief.cell_m > 0 && surface_mesh == nullptr; }
  /// Returns whether each transmission has a surface mesh of its own.
  bool has_surface_per_transmission() const {
    return surface_mesh != nullptr || moving != nullptr || scene.water->refracts();
  }
  /// Returns the number that a facet of the mesh has in the whole scene. Thread-safe. Throws the errors of
  /// FacetNumbering().
  FacetId number_of(FacetId facet) const;
  /// Returns the number of the facet before relief that contains a facet.
  FacetId base_number_of(FacetId facet) const;
  /// Returns the facet numbers of a tiled scene. Thread-safe.
  const FacetNumbering& numbering() const;
  /// Returns the facet numbers of a tiled scene before relief. Thread-safe.
  const FacetNumbering& base_numbering() const;
  /// Returns the vertices of the mesh in metres. The first call computes them. Thread-safe.
  const std::vector<glm::dvec3>& vertices_m() const;
  /// Returns the facets as a scene for rays. The first call builds it. Thread-safe. Throws the errors of
  /// RayScene().
  const RayScene& rays() const;

 private:
  mutable std::once_flag rays_made_, vertices_made_, numbered_, numbering_made_, base_numbered_,
      base_numbering_made_;
  mutable std::unique_ptr<const RayScene> rays_;
  mutable std::vector<glm::dvec3> vertices_m_;
  /// for a part: by facet, and by facet before relief
  mutable std::vector<FacetId> numbers_, base_numbers_;
  mutable std::unique_ptr<const FacetNumbering> numbering_, base_numbering_;  ///< for a tiled scene
};

}  // namespace tubefoot
