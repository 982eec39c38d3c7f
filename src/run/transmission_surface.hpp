// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "engine/surface/refracted_surface.hpp"
#include "engine/surface/surface_mesh.hpp"
#include "run/loaded_scene.hpp"

namespace tubefoot {

class Transmission;

/// The facets that a transmission meets. They are those of the loaded scene, the same with moving objects at
/// their places, or a refinement for this transmission. This object owns facets that the loaded scene does
/// not have.
class TransmissionSurface {
 public:
  /// Uses the facets of the loaded scene.
  explicit TransmissionSurface(const LoadedScene& loaded_scene) : loaded_scene_(&loaded_scene) {}
  /// Uses the facets of the loaded scene at another time.
  TransmissionSurface(const LoadedScene& loaded_scene, MovedFacets moved)
      : loaded_scene_(&loaded_scene), moved_(std::move(moved)) {}
  TransmissionSurface(const LoadedScene& loaded_scene, RefinedMesh refined)
      : loaded_scene_(&loaded_scene),
        refined_(std::make_unique<RefinedMesh>(std::move(refined))),
        tree_(std::make_unique<SceneTree>(refined_->mesh, SceneTree::HeightFieldSearch::ignored)) {}

  /// Uses the apparent surface that the sonar sees through refracting water.
  TransmissionSurface(const LoadedScene& loaded_scene, ApparentSurface apparent)
      : loaded_scene_(&loaded_scene),
        apparent_(std::make_unique<ApparentSurface>(std::move(apparent))),
        tree_(std::make_unique<SceneTree>(apparent_->refined.mesh, SceneTree::HeightFieldSearch::ignored)) {}

  const FacetMesh& mesh() const {
    return is_own() ? own().mesh : moved_ ? *moved_->mesh() : loaded_scene_->scene.mesh;
  }
  const SceneTree& tree() const {
    return is_own() ? *tree_ : moved_ ? *moved_->tree() : *loaded_scene_->tree;
  }
  /// Returns whether the surface has facets with numbers of its own.
  bool is_own() const { return tree_ != nullptr; }
  /// Returns whether the surface has the facets and the vertices of the loaded scene.
  bool is_of_loaded_scene() const { return !is_own() && !moved_; }
  /// Returns the number of a facet: its index in this surface, or its number in the whole scene if it
  /// belongs to the loaded scene.
  FacetId number_of(FacetId facet) const { return is_own() ? facet : loaded_scene_->number_of(facet); }
  /// Returns the facet of the unrefined scene that contains a facet, by its number in the whole scene.
  FacetId base_facet(FacetId facet) const {
    if (is_own()) facet = own().parent[facet];
    return loaded_scene_->base_number_of(facet);
  }
  /// Returns the transmission's own facets as parts of the scene's facets; null if it uses the facets of the
  /// loaded scene.
  const RefinedMesh* refined() const { return is_own() ? &own() : nullptr; }
  /// Returns the facets of the loaded scene at another time; null if the surface has others.
  const MovedFacets* moved() const { return moved_ ? &*moved_ : nullptr; }
  /// Returns null if apparent and true positions are equal.
  const ApparentSurface* apparent() const { return apparent_.get(); }

 private:
  const RefinedMesh& own() const { return apparent_ ? apparent_->refined : *refined_; }

  const LoadedScene* loaded_scene_;
  std::optional<MovedFacets> moved_;
  std::unique_ptr<RefinedMesh> refined_;
  std::unique_ptr<ApparentSurface> apparent_;
  std::unique_ptr<SceneTree> tree_;
};

/// Makes the surface of a transmission, which Transmission::surface_mesh() keeps. `weights`: whether to
/// compute RefinedMesh::weights relative to the scene's facets. Throws InputError if there are too many
/// facets.
TransmissionSurface surface_mesh_of(const Transmission& transmission, bool weights = false);
/// Makes the surface of a transmission at its true position, also in refracting water.
TransmissionSurface lying_surface_of(const Transmission& transmission, bool weights = false);
/// Makes the surface that paths via mirrors meet: the one of lying_surface_of(), without the facets of the
/// sea surface. The mirror is their mean plane, which they cross.
TransmissionSurface path_surface_of(const Transmission& transmission, bool weights = false);
/// Returns whether path_surface_of() differs from the surface of a transmission.
bool has_path_surface(const Scene& scene);
/// Removes the facets of the sea surface, which are the last of a mesh. Does nothing for a scene without
/// them.
void drop_sea_surface(const Scene& scene, FacetMesh& mesh);
/// Returns the relief in the view of a transmission. Throws InputError if there are too many facets.
RefinedMesh relief_seen_by(const Transmission& transmission, std::span<const Look> looks,
                           bool weights = false);
/// Returns the mirrors within a distance of a transmission, with their relief, and the moving objects. Throws
/// the errors of relief_seen_by().
RefinedMesh mirrors_about(const Transmission& transmission, double distance_m);
/// Removes the parts of a mesh above the height of [sea_surface], except the facets of the sea surface.
/// Adapts `parent`, by facet, and the optional `weights`. Returns false if the whole mesh was in the water.
bool cut_at_surface(const Scene& scene, FacetMesh& mesh, std::vector<FacetId>& parent,
                    std::vector<PartWeights>* weights = nullptr);
/// Returns the surface above and below a position, with moving objects at a time. Throws the errors of
/// place_moving().
TransmissionSurface surface_in_line_with(const LoadedScene& loaded_scene, glm::dvec3 place_m, double time_s);
/// Returns the facets of a loaded scene without relief, with moving objects at the time of a transmission.
/// `weights` as in surface_mesh_of(). Throws the errors of place_moving().
TransmissionSurface moved_surface_of(const Transmission& transmission, bool weights = false);
/// Returns the facets of a loaded scene with moving objects at a time, before the sea surface cuts them.
/// Throws the errors of place_moving().
TransmissionSurface surface_at(const LoadedScene& loaded_scene, double time_s);

/// Prepares the relief of a scene. Without relief it does nothing. For online relief it makes the data that
/// surface_mesh_of() needs. For offline relief it refines the scene's facets, or loads the refined ones;
/// refine_part() then refines the tiles of a tiled scene. Throws InputError.
void lay_relief(LoadedScene& loaded_scene);
/// Refines a part of a tiled scene, which contains these tiles and their surface mesh. Throws InputError.
void refine_part(const LoadedScene& whole, const TileChoice& tiles, LoadedScene& part);
/// Returns the refined parts of some facets of `part`, a scene with some tiles of a tiled scene. `names`:
/// numbers of these facets before relief. The parents of the result are facets of `part`. Throws InputError.
RefinedMesh refined_part(const LoadedScene& whole, const Scene& part, std::span<const FacetId> facets,
                         std::span<const FacetId> names);

/// Returns the surface that lay_relief() refines, for a scene with relief. `base` has the facets of the
/// scene, or those at rest, and must outlive the result. Throws InputError.
std::unique_ptr<SurfaceMesh> relief_surface(const Scene& scene, const FacetMesh& base);
/// Returns the whole seabed, refined to cells. Throws InputError if there are too many cells.
RefinedMesh refined_seabed(const Scene& scene, const SurfaceMesh& surface_mesh);

}  // namespace tubefoot
