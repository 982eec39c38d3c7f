// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "engine/ground/ground.hpp"
#include "engine/ground/refracted_ground.hpp"
#include "run/survey.hpp"

namespace tubefoot {

/// The facets that a shot meets: the scene's own, or a refinement for this shot, which lives as long as this.
class ShotGround {
 public:
  /// The scene's own facets.
  explicit ShotGround(const Survey& survey) : survey_(&survey) {}
  ShotGround(const Survey& survey, RefinedMesh refined)
      : survey_(&survey),
        refined_(std::make_unique<RefinedMesh>(std::move(refined))),
        tree_(std::make_unique<SceneTree>(refined_->mesh, SceneTree::Sheets::ignored)) {}

  /// As the sonar sees it through refracting water.
  ShotGround(const Survey& survey, ApparentGround apparent)
      : survey_(&survey),
        apparent_(std::make_unique<ApparentGround>(std::move(apparent))),
        tree_(std::make_unique<SceneTree>(apparent_->refined.mesh, SceneTree::Sheets::ignored)) {}

  const FacetMesh& mesh() const { return is_own() ? own().mesh : survey_->scene.mesh; }
  const SceneTree& tree() const { return is_own() ? *tree_ : *survey_->tree; }
  bool is_own() const { return tree_ != nullptr; }
  /// The facet of the unrefined scene that a facet is part of.
  FacetId base_facet(FacetId facet) const {
    if (is_own()) facet = own().parent[facet];
    return survey_->relief.parent.empty() ? facet : survey_->relief.parent[facet];
  }
  /// Null where facets are where they seem to be.
  const ApparentGround* apparent() const { return apparent_.get(); }

 private:
  const RefinedMesh& own() const { return apparent_ ? apparent_->refined : *refined_; }

  const Survey* survey_;
  std::unique_ptr<RefinedMesh> refined_;
  std::unique_ptr<ApparentGround> apparent_;
  std::unique_ptr<SceneTree> tree_;
};

/// The ground of a shot of a group, for all its sensors; seen by the receiver too where that is apart.
/// Throws InputError where it takes too many facets.
ShotGround ground_of(const Survey& survey, const SharedShots& group, std::size_t ping, std::size_t shot);
/// What a shot asks of relief that is refined for it, by its tubes (two sets where the receiver is apart),
/// which outlive the looks.
std::vector<Look> looks_of(const Survey& survey, const SharedShots& group, std::size_t ping, std::size_t shot,
                           std::span<const TubeSet> tubes);
/// The relief that a shot sees. Throws InputError where it takes too many facets.
RefinedMesh relief_seen_by(const Survey& survey, const SharedShots& group, std::size_t ping, std::size_t shot,
                           std::span<const Look> looks);
/// The ground above and below a place.
ShotGround ground_in_line_with(const Survey& survey, glm::dvec3 place_m);

/// The length of a range sample of a group: the shortest of its sensors'.
double sample_length_m(const Survey& survey, const SharedShots& group);

/// Settles how a scene's relief gets into its facets: nothing without relief; online, what ground_of() needs;
/// offline, the scene's facets are refined (or loaded) here. Throws InputError.
void lay_relief(Survey& survey);

/// The ground that lay_relief() refines, for a scene with relief. Throws InputError.
std::unique_ptr<Ground> relief_ground(const Scene& scene);
/// All of it in cells. Throws InputError where those are too many.
RefinedMesh refined_bed(const Scene& scene, const Ground& ground);

}  // namespace tubefoot
