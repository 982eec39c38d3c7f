// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/transmission.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "engine/rays/shared_hits.hpp"
#include "run/labels.hpp"
#include "run/transmission_rays.hpp"

// This file implements the interface from a survey to one transmission: its tubes, surface mesh, visibility
// and echoes.

namespace tubefoot {
namespace {

/// Extends the reach for a separate receiver. Half of the path from transmitter to receiver is no less than
/// the range from either of them, minus half of the distance between them.
TubeSet reaching_beyond(const Transmission& transmission, const SensorPings& pings, TubeSet set) {
  set.reach += glm::distance(pings.transmission_pose(transmission.ping(), transmission.number()).position_m,
                             pings.receiver_pose(transmission.ping(), transmission.number()).position_m) /
               (2 * transmission.scene().grid.unit_m());
  return set;
}

}  // namespace

SensorModel::SensorModel(const Transmission& transmission, const TransmissionSurface& surface_mesh,
                         std::size_t sensor) {
  const Scene& scene = transmission.scene();
  const SensorPings& pings = transmission.survey().sensors[sensor];
  model = {scene.material_mu, surface_mesh.mesh().material,
           absorption_db_per_m(scene, *pings.sensor, transmission.number())};
  model.reflectivity = scene.reflectivity;
  model.scattering = scene.scattering;
  model.path.tx.apex_m = scene.grid.to_metres(
      scene.grid.snap(pings.transmission_pose(transmission.ping(), transmission.number()).position_m));
  if (surface_mesh.apparent() != nullptr) {
    model.path.facet_factor = surface_mesh.apparent()->facet_factor;
    if (transmission.labels() != nullptr ||
        std::any_of(scene.reflectivity.begin(), scene.reflectivity.end(),
                    [](const auto& texture) { return texture != nullptr; })) {
      facet_maps = surface_mesh.apparent()->facet_maps(model.path.tx.apex_m, scene.grid);
      model.path.tx.facet_map = facet_maps;
    }
  }
  if (!pings.sensor->has_patterns()) return;
  patterns = pings.sensor->patterns(pings.transmission_pose(transmission.ping(), transmission.number()),
                                    pings.receiver_pose(transmission.ping(), transmission.number()),
                                    pings.sound_speed_m_s, transmission.number());
  model.patterns = &patterns;
  if (surface_mesh.apparent() == nullptr || patterns.baselines.empty()) return;
  // Phases depend on the sound speed at the receiver pair, but ranges are computed with the sound speed at
  // the sensor's first position.
  const double depth_m = scene.water->surface_height_m() -
                         pings.transmission_pose(transmission.ping(), transmission.number()).position_m.z;
  for (ReceiverBaseline& baseline : patterns.baselines)
    baseline.baseline_m *= pings.sound_speed_m_s / scene.water->profile().at(depth_m);
}

Transmissions::Transmissions(Survey survey, RunRequest request)
    : survey_(std::move(survey)),
      request_(std::move(request)),
      whole_(*survey_.loaded_scene),
      engine_(whole_.mesh(), whole_.tree(), survey_.scene.grid.unit_m(), request_.visibility),
      labels_(request_.labels ? std::make_unique<const LabelChannels>(survey_, request_) : nullptr) {}
Transmissions::~Transmissions() = default;

Transmission Transmissions::of(const SharedTransmissions& group, std::size_t ping, std::size_t number) const {
  return Transmission(*this, group, ping, number);
}

Transmission Transmissions::received_by(std::size_t sensor, std::size_t ping, std::size_t number) const {
  return Transmission(*this, survey_.sensor_set->transmissions_of(sensor), ping, number);
}

Transmission::Transmission(const Transmissions& transmissions, const SharedTransmissions& group,
                           std::size_t ping, std::size_t number)
    : transmissions_(transmissions), group_(group), ping_(ping), number_(number) {}

std::string Transmission::name() const {
  return fmt::format("transmission {} of ping {} of sensor '{}'", number_, ping_,
                     pings().sensor->description().name);
}

double Transmission::sample_length_m() const {
  double shortest = pings().sensor->samples().step_m;
  for (const std::size_t s : group_.sensors) shortest = std::min(shortest, sensor(s).samples().step_m);
  return shortest;
}

TubeSet Transmission::tubes() const {
  const WorldGrid& grid = scene().grid;
  TubeSet set = tubes_of(first());
  for (const std::size_t s : group_.sensors) set.reach = std::max(set.reach, sensor(s).reach(grid, number_));
  return reaching_beyond(*this, pings(), std::move(set));
}

TubeSet Transmission::tubes_of(std::size_t s) const {
  return has_separate_receiver() ? sensor(s).transmit_tubes(pose(), scene().grid, number_)
                                 : sensor(s).tubes(pose(), scene().grid, number_);
}

TubeSet Transmission::receive_tubes(std::size_t s) const {
  const SensorPings& its = survey().sensors[s];
  return reaching_beyond(*this, its,
                         its.sensor->tubes(its.receiver_pose(ping_, number_), scene().grid, number_));
}

std::vector<Look> Transmission::looks(std::span<const TubeSet> tubes) const {
  double nearest = pings().sensor->samples().first_m;
  for (const std::size_t s : group_.sensors) nearest = std::min(nearest, sensor(s).samples().first_m);
  if (tubes.size() > 1)  // half of the path may exceed the distance from the nearer end by up to half of the
                         // distance between the ends
    nearest = std::max(nearest - glm::distance(pose().position_m, receiver_pose().position_m) / 2, 0.0);
  std::vector<Look> looks;
  for (const TubeSet& set : tubes) looks.push_back({&set, nearest, sample_length_m()});
  return looks;
}

const TransmissionSurface& Transmission::surface_mesh() const {
  if (!loaded_scene().has_surface_per_transmission()) return transmissions_.whole_;
  if (!surface_mesh_) {
    // Derivatives by vertices of the scene need the places of refined vertices.
    surface_mesh_.emplace(surface_mesh_of(*this, !request().gradient.empty()));
    own_engine_.emplace(surface_mesh_->mesh(), surface_mesh_->tree(), scene().grid.unit_m(),
                        request().visibility);
  }
  return *surface_mesh_;
}

const TubeEngine& Transmission::engine() const {
  surface_mesh();
  return own_engine_ ? *own_engine_ : transmissions_.engine_;
}

History Transmission::trace(std::size_t* candidates, bool measured, const std::vector<bool>& wanted) const {
  return engine().trace(tubes(), candidates, measured, wanted);
}

History Transmission::trace(TubeSet tubes, std::size_t* candidates, bool measured) const {
  return engine().trace(std::move(tubes), candidates, measured);
}

std::vector<TubeAudit> Transmission::audit(std::uint64_t label) const {
  return engine().audit(tubes(), label);
}

BistaticHistory Transmission::trace_both() const {
  return trace_bistatic(surface_mesh().mesh(), surface_mesh().tree(), scene().grid.unit_m(),
                        request().visibility, tubes(), receive_tubes(first()),
                        request().reference_tolerance && !request().rounds_corners);
}

void Transmission::trace_rays_of_both(const RayScene& rays, const RaySettings& settings,
                                      const std::function<void(const BistaticHistory&)>& take) const {
  const TubeSet receive = receive_tubes(first());
  History history;
  history.tubes = tubes();
  history.grid_unit_m = scene().grid.unit_m();
  const TubeFinder sent_tubes(history.tubes), received_tubes(receive);
  const SampledEnd sent{rays, history.tubes, sent_tubes}, received{rays, receive, received_tubes};
  const RayGuide guide = guide_of(*this);
  trace_rays(
      rays, history, settings, sensor(first()).beam_of_tube(number_),
      [&] { take(shared_hits(history, sent, received, surface_mesh().mesh())); }, nullptr, &guide);
}

ReceiverPairHistory Transmission::trace_receiver_pair(std::size_t s, std::uint32_t fan,
                                                      const ReceiverBaseline& receiver_pair) const {
  const std::vector<std::uint32_t> fans = sensor(s).fan_of_tube(number_);
  return tubefoot::trace_receiver_pair(
      surface_mesh().mesh(), surface_mesh().tree(), scene().grid.unit_m(), request().visibility,
      tubes_of_fan(tubes(), fans, fan),
      tubes_of_fan(has_separate_receiver() ? receive_tubes(s) : tubes(), fans, fan), receiver_pair,
      request().reference_tolerance && !request().rounds_corners);
}

ReceiveBeams Transmission::beams_by_fans(std::size_t s, const std::vector<std::uint32_t>& fans) const {
  return {beams(s), sensor(s).beam_of_tube(number_), fans, fans};
}

Echo Transmission::echo(const CommonVisibility& visibility, std::size_t s, const EchoModel& model) const {
  const std::vector<std::uint32_t> fans = sensor(s).fan_of_tube(number_);
  return integrate_echo(visibility, beams_by_fans(s, fans), samples(s), model, request().binning);
}

ReceiverPairEcho Transmission::echo(const ReceiverPairHistory& history, std::size_t s, std::uint32_t fan,
                                    const SensorModel& model) const {
  return integrate_receiver_pair_echo(history, model.patterns.baselines[fan], fan, fan, samples(s),
                                      model.model);
}

}  // namespace tubefoot
