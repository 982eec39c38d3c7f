// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "engine/ground/ground.hpp"
#include "engine/ground/refracted_ground.hpp"
#include "run/site.hpp"

namespace tubefoot {

class Shot;

/// The facets that a shot meets: the site's own, or a refinement for this shot, which lives as long as this.
class ShotGround {
 public:
  /// The site's own facets.
  explicit ShotGround(const Site& site) : site_(&site) {}
  ShotGround(const Site& site, RefinedMesh refined)
      : site_(&site),
        refined_(std::make_unique<RefinedMesh>(std::move(refined))),
        tree_(std::make_unique<SceneTree>(refined_->mesh, SceneTree::Sheets::ignored)) {}

  /// As the sonar sees it through refracting water.
  ShotGround(const Site& site, ApparentGround apparent)
      : site_(&site),
        apparent_(std::make_unique<ApparentGround>(std::move(apparent))),
        tree_(std::make_unique<SceneTree>(apparent_->refined.mesh, SceneTree::Sheets::ignored)) {}

  const FacetMesh& mesh() const { return is_own() ? own().mesh : site_->scene.mesh; }
  const SceneTree& tree() const { return is_own() ? *tree_ : *site_->tree; }
  bool is_own() const { return tree_ != nullptr; }
  /// The facet of the unrefined scene that a facet is part of.
  FacetId base_facet(FacetId facet) const {
    if (is_own()) facet = own().parent[facet];
    return site_->relief.parent.empty() ? facet : site_->relief.parent[facet];
  }
  /// Facets of the shot's own, as parts of the scene's; null: the site's own.
  const RefinedMesh* refined() const { return is_own() ? &own() : nullptr; }
  /// Null where facets are where they seem to be.
  const ApparentGround* apparent() const { return apparent_.get(); }

 private:
  const RefinedMesh& own() const { return apparent_ ? apparent_->refined : *refined_; }

  const Site* site_;
  std::unique_ptr<RefinedMesh> refined_;
  std::unique_ptr<ApparentGround> apparent_;
  std::unique_ptr<SceneTree> tree_;
};

/// The ground of a shot (Shot::ground() keeps it), if asked for with RefinedMesh::weights about the scene's
/// facets. Throws InputError where it takes too many facets.
ShotGround ground_of(const Shot& shot, bool weights = false);
/// The relief that a shot sees. Throws InputError where it takes too many facets.
RefinedMesh relief_seen_by(const Shot& shot, std::span<const Look> looks, bool weights = false);
/// The ground above and below a place.
ShotGround ground_in_line_with(const Site& site, glm::dvec3 place_m);

/// Settles how a scene's relief gets into its facets: nothing without relief; online, what ground_of() needs;
/// offline, the scene's facets are refined (or loaded) here. Throws InputError.
void lay_relief(Site& site);

/// The ground that lay_relief() refines, for a scene with relief. Throws InputError.
std::unique_ptr<Ground> relief_ground(const Scene& scene);
/// All of it in cells. Throws InputError where those are too many.
RefinedMesh refined_bed(const Scene& scene, const Ground& ground);

}  // namespace tubefoot
