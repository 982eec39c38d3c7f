// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/shot_ends.hpp"

#include "engine/sight/part_label.hpp"

namespace tubefoot {

ShotEnds::ShotEnds(const Shot& shot, std::size_t sensor, bool weights) : shot_(shot) {
  const bool apart = shot.has_receiver_apart();
  if (apart && shot.scene().water->refracts()) {
    pair_.emplace(refracted_pair_of(shot, weights));
    const ApparentPair& pair = pair_->apparent;
    pair_parent_.resize(pair.mesh.facets.size());
    const auto add = [&](const TubeSet& tubes, const ApparentGround& ground,
                         const std::vector<FacetId>& origin) {
      for (std::size_t k = 0; k < origin.size(); ++k) pair_parent_[origin[k]] = ground.refined.parent[k];
      trees_.push_back(std::make_unique<SceneTree>(ground.refined.mesh, SceneTree::Sheets::ignored));
      ends_.push_back({tubes, &ground.refined.mesh, trees_.back().get(), &ground.refined, &ground, origin});
    };
    add(pair_->transmit_tubes, pair.transmit, pair.transmit_origin);
    add(pair_->receive_tubes, pair.receive, pair.receive_origin);
    return;
  }
  if (weights && shot.site().has_ground_a_shot()) ground_.emplace(ground_of(shot, true));
  const ShotGround& ground = ground_ ? *ground_ : shot.ground();
  const auto add = [&](TubeSet tubes) {
    ends_.push_back({std::move(tubes),
                     &ground.mesh(),
                     &ground.tree(),
                     ground.refined(),
                     ground.apparent(),
                     {},
                     ground.is_own() ? nullptr : &shot.site()});
  };
  add(apart ? shot.tubes() : shot.tubes_of(sensor));
  if (apart) add(shot.receive_tubes(sensor));
}

FacetId ShotEnds::base_facet(FacetId shared) const {
  if (pair_)
    shared = pair_parent_[shared];
  else if (out().refined != nullptr)
    shared = out().refined->parent[shared];
  return shot_.site().base_number_of(shared);
}

History ShotEnds::trace(const ShotEnd& end) const {
  return TubeEngine(*end.mesh, *end.tree, shot_.scene().grid.unit_m(), shot_.request().visibility)
      .trace(end.tubes);
}

std::unique_ptr<SensorLaw> ShotEnds::law(std::size_t sensor) const {
  auto law = std::make_unique<SensorLaw>(shot_, ShotGround(shot_.site()), sensor);
  law->law.material = shared_mesh().material;
  return law;
}

BistaticHistory ShotEnds::trace() const {
  if (pair_) return trace_both(shot_, *pair_);
  return trace_bistatic(*out().mesh, *out().tree, shot_.scene().grid.unit_m(), shot_.request().visibility,
                        out().tubes, home().tubes);
}

BistaticAudit ShotEnds::audit(std::uint64_t label) const {
  VisibilityOptions options = shot_.request().visibility;
  options.open_water = true;
  const auto sent = look(*out().mesh, *out().tree, out().tubes, options),
             heard = look(*home().mesh, *home().tree, home().tubes, options);
  const double unit_m = shot_.scene().grid.unit_m();
  constexpr std::uint64_t of_home = std::uint64_t{1} << 62;
  BistaticAudit result{audit_tubes(*out().mesh, out().tubes, sent, label),
                       audit_tubes(*home().mesh, home().tubes, heard, label_of_part(label, of_home)),
                       {}};
  const auto audit = [&](const FootprintSharer& sharer) { result.shared = audit_shared(sharer, label); };
  if (pair_)
    audit(FootprintSharer({out().tubes, sent, out().mesh, out().name},
                          {home().tubes, heard, home().mesh, home().name}, unit_m));
  else
    audit(FootprintSharer(*out().mesh, {out().tubes, sent}, {home().tubes, heard}, unit_m));
  return result;
}

}  // namespace tubefoot
