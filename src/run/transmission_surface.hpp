// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "engine/surface/refracted_surface.hpp"
#include "engine/surface/surface_mesh.hpp"
#include "run/loaded_scene.hpp"

namespace tubefoot {

class Transmission;

/// The facets that a transmission meets: the loaded scene's own, or a refinement for this transmission, which
/// lives as long as this.
class TransmissionSurface {
 public:
  /// The site's own facets.
  explicit TransmissionSurface(const LoadedScene& loaded_scene) : loaded_scene_(&loaded_scene) {}
  TransmissionSurface(const LoadedScene& loaded_scene, RefinedMesh refined)
      : loaded_scene_(&loaded_scene),
        refined_(std::make_unique<RefinedMesh>(std::move(refined))),
        tree_(std::make_unique<SceneTree>(refined_->mesh, SceneTree::HeightFieldSearch::ignored)) {}

  /// As the sonar sees it through refracting water.
  TransmissionSurface(const LoadedScene& loaded_scene, ApparentSurface apparent)
      : loaded_scene_(&loaded_scene),
        apparent_(std::make_unique<ApparentSurface>(std::move(apparent))),
        tree_(std::make_unique<SceneTree>(apparent_->refined.mesh, SceneTree::HeightFieldSearch::ignored)) {}

  const FacetMesh& mesh() const { return is_own() ? own().mesh : loaded_scene_->scene.mesh; }
  const SceneTree& tree() const { return is_own() ? *tree_ : *loaded_scene_->tree; }
  bool is_own() const { return tree_ != nullptr; }
  /// What a facet is called: its number in this ground, or, of the loaded scene's own, in all of the scene.
  FacetId number_of(FacetId facet) const { return is_own() ? facet : loaded_scene_->number_of(facet); }
  /// The facet of the unrefined scene that a facet is part of, by its number in all of the scene.
  FacetId base_facet(FacetId facet) const {
    if (is_own()) facet = own().parent[facet];
    return loaded_scene_->base_number_of(facet);
  }
  /// Facets of the transmission's own, as parts of the scene's; null: the loaded scene's own.
  const RefinedMesh* refined() const { return is_own() ? &own() : nullptr; }
  /// Null where facets are where they seem to be.
  const ApparentSurface* apparent() const { return apparent_.get(); }

 private:
  const RefinedMesh& own() const { return apparent_ ? apparent_->refined : *refined_; }

  const LoadedScene* loaded_scene_;
  std::unique_ptr<RefinedMesh> refined_;
  std::unique_ptr<ApparentSurface> apparent_;
  std::unique_ptr<SceneTree> tree_;
};

/// The surface of a transmission (Transmission::ground() keeps it), if asked for with RefinedMesh::weights
/// about the scene's facets. Throws InputError where it takes too many facets.
TransmissionSurface surface_mesh_of(const Transmission& transmission, bool weights = false);
/// The same where it lies, also in water that refracts.
TransmissionSurface lying_surface_of(const Transmission& transmission, bool weights = false);
/// The relief that a transmission sees. Throws InputError where it takes too many facets.
RefinedMesh relief_seen_by(const Transmission& transmission, std::span<const Look> looks,
                           bool weights = false);
/// The mirrors within a distance of a transmission, with their relief, and nothing else. Throws as
/// relief_seen_by().
RefinedMesh mirrors_about(const Transmission& transmission, double distance_m);
/// Leaves of a mesh what is in the water of a scene with [sea_surface], and of `parent`, by facet, what
/// belongs to it; of `weights`, if given, where it lies. False: all of it was.
bool cut_at_surface(const Scene& scene, FacetMesh& mesh, std::vector<FacetId>& parent,
                    std::vector<PartWeights>* weights = nullptr);
/// The surface above and below a place.
TransmissionSurface surface_in_line_with(const LoadedScene& loaded_scene, glm::dvec3 place_m);

/// Settles how a scene's relief gets into its facets: nothing without relief; online, what surface_mesh_of()
/// needs; offline, the scene's facets are refined (or loaded) here, and of a tiled site those of tiles by
/// refine_part(). Throws InputError.
void lay_relief(LoadedScene& loaded_scene);
/// Refines a part of a tiled site, that has these tiles and its ground. Throws InputError.
void refine_part(const LoadedScene& whole, const TileChoice& tiles, LoadedScene& part);
/// The parts of some facets of a scene with some of a tiled site's tiles, and what these facets are called
/// before relief. `parent`: of the scene. Throws InputError.
RefinedMesh refined_part(const LoadedScene& whole, const Scene& part, std::span<const FacetId> facets,
                         std::span<const FacetId> names);

/// The surface that lay_relief() refines, for a scene with relief. Throws InputError.
std::unique_ptr<SurfaceMesh> relief_surface(const Scene& scene);
/// All of it in cells. Throws InputError where those are too many.
RefinedMesh refined_seabed(const Scene& scene, const SurfaceMesh& surface_mesh);

}  // namespace tubefoot
