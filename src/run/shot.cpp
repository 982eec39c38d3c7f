// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/shot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "engine/rays/shared_hits.hpp"
#include "run/shot_rays.hpp"
#include "run/truth.hpp"

namespace tubefoot {
namespace {

/// Half of the path from transmitter to receiver is no less than the range from either of them, less half of
/// the way between them.
TubeSet reaching_beyond(const Shot& shot, const SensorPings& pings, TubeSet set) {
  set.reach += glm::distance(pings.shot_pose(shot.ping(), shot.number()).position_m,
                             pings.receiver_pose(shot.ping(), shot.number()).position_m) /
               (2 * shot.scene().grid.unit_m());
  return set;
}

}  // namespace

Shots::Shots(Survey survey, RunRequest request)
    : survey_(std::move(survey)),
      request_(std::move(request)),
      whole_(*survey_.site),
      engine_(whole_.mesh(), whole_.tree(), survey_.scene.grid.unit_m(), request_.visibility),
      truth_(request_.truth ? std::make_unique<const Truth>(survey_, request_) : nullptr) {}
Shots::~Shots() = default;

Shot Shots::of(const SharedShots& group, std::size_t ping, std::size_t number) const {
  return Shot(*this, group, ping, number);
}

Shot Shots::heard_by(std::size_t sensor, std::size_t ping, std::size_t number) const {
  return Shot(*this, survey_.fleet->shots_of(sensor), ping, number);
}

Shot::Shot(const Shots& shots, const SharedShots& group, std::size_t ping, std::size_t number)
    : shots_(shots), group_(group), ping_(ping), number_(number) {}

std::string Shot::name() const {
  return fmt::format("shot {} of ping {} of sensor '{}'", number_, ping_, pings().sensor->description().name);
}

double Shot::sample_length_m() const {
  double shortest = pings().sensor->samples().step_m;
  for (const std::size_t s : group_.sensors) shortest = std::min(shortest, sensor(s).samples().step_m);
  return shortest;
}

TubeSet Shot::tubes() const {
  const WorldGrid& grid = scene().grid;
  TubeSet set = tubes_of(first());
  for (const std::size_t s : group_.sensors) set.reach = std::max(set.reach, sensor(s).reach(grid));
  return reaching_beyond(*this, pings(), std::move(set));
}

TubeSet Shot::tubes_of(std::size_t s) const { return sensor(s).tubes(pose(), scene().grid, number_); }

TubeSet Shot::receive_tubes(std::size_t s) const {
  const SensorPings& its = survey().sensors[s];
  return reaching_beyond(*this, its,
                         its.sensor->tubes(its.receiver_pose(ping_, number_), scene().grid, number_));
}

std::vector<Look> Shot::looks(std::span<const TubeSet> tubes) const {
  double nearest = pings().sensor->samples().first_m;
  for (const std::size_t s : group_.sensors) nearest = std::min(nearest, sensor(s).samples().first_m);
  if (tubes.size() >
      1)  // half the path is longer than the way from the nearer end by up to half of what lies between
    nearest = std::max(nearest - glm::distance(pose().position_m, receiver_pose().position_m) / 2, 0.0);
  std::vector<Look> looks;
  for (const TubeSet& set : tubes) looks.push_back({&set, nearest, sample_length_m()});
  return looks;
}

const ShotGround& Shot::ground() const {
  if (!site().has_ground_a_shot()) return shots_.whole_;
  if (!ground_) {
    ground_.emplace(ground_of(*this));
    own_engine_.emplace(ground_->mesh(), ground_->tree(), scene().grid.unit_m(), request().visibility);
  }
  return *ground_;
}

const TubeEngine& Shot::engine() const {
  ground();
  return own_engine_ ? *own_engine_ : shots_.engine_;
}

History Shot::trace(std::size_t* candidates, bool measured, const std::vector<bool>& wanted) const {
  return engine().trace(tubes(), candidates, measured, wanted);
}

History Shot::trace(TubeSet tubes, std::size_t* candidates, bool measured) const {
  return engine().trace(std::move(tubes), candidates, measured);
}

std::vector<TubeAudit> Shot::audit(std::uint64_t label) const { return engine().audit(tubes(), label); }

BistaticHistory Shot::trace_both() const {
  return trace_bistatic(ground().mesh(), ground().tree(), scene().grid.unit_m(), request().visibility,
                        tubes(), receive_tubes(first()));
}

void Shot::trace_rays_of_both(const RayScene& rays, const RaySettings& settings,
                              const std::function<void(const BistaticHistory&)>& take) const {
  const TubeSet receive = receive_tubes(first());
  History history;
  history.tubes = tubes();
  history.grid_unit_m = scene().grid.unit_m();
  const TubeFinder sent_tubes(history.tubes), heard_tubes(receive);
  const SampledEnd sent{rays, history.tubes, sent_tubes}, heard{rays, receive, heard_tubes};
  const RayGuide guide = guide_of(*this);
  trace_rays(
      rays, history, settings, sensor(first()).beam_of_tube(number_),
      [&] { take(shared_hits(history, sent, heard, ground().mesh())); }, nullptr, &guide);
}

StaffHistory Shot::trace_staff(std::size_t s, std::uint32_t fan, const Fringe& staff) const {
  const std::vector<std::uint32_t> fans = sensor(s).fan_of_tube(number_);
  return tubefoot::trace_staff(ground().mesh(), ground().tree(), scene().grid.unit_m(), request().visibility,
                               tubes_of_fan(tubes(), fans, fan),
                               tubes_of_fan(has_receiver_apart() ? receive_tubes(s) : tubes(), fans, fan),
                               staff);
}

ReceiveBeams Shot::beams_by_fans(std::size_t s, const std::vector<std::uint32_t>& fans) const {
  return {beams(s), sensor(s).beam_of_tube(number_), fans, fans};
}

Echo Shot::echo(const Sight& sight, std::size_t s, const EchoLaw& law) const {
  const std::vector<std::uint32_t> fans = sensor(s).fan_of_tube(number_);
  return integrate_echo(sight, beams_by_fans(s, fans), sensor(s).samples(), law, request().binning);
}

StaffEcho Shot::echo(const StaffHistory& history, std::size_t s, std::uint32_t fan,
                     const SensorLaw& law) const {
  return integrate_staff_echo(history, law.patterns.fringes[fan], fan, fan, sensor(s).samples(), law.law);
}

}  // namespace tubefoot
