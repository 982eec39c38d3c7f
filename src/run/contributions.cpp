// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/contributions.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "engine/certified/receiver_pair_reference.hpp"
#include "engine/echo/volume_echo.hpp"
#include "engine/rays/ray_engine.hpp"
#include "engine/visibility/mixed_eigenrays.hpp"
#include "run/fresnel_borders.hpp"
#include "run/gradients.hpp"
#include "run/label_parts.hpp"
#include "run/own_engine_part.hpp"
#include "run/path_parts.hpp"
#include "run/paths.hpp"
#include "run/receiver_pair_rows.hpp"
#include "run/refracted_reference.hpp"
#include "run/refraction.hpp"
#include "run/signal_gradients.hpp"
#include "run/signals.hpp"
#include "run/transmission_images.hpp"
#include "run/transmission_rays.hpp"
#include "run/volume_part.hpp"
#include "run/water_targets.hpp"

// This file plans the contributions to the echoes of transmissions. It implements those of the direct path to
// a facet and back. They are echoes from one surface, separate receivers, receiver pairs, mixed-eigenray
// returns, and references in refracting water.

namespace tubefoot {
namespace {

/// Adds the counts of a reference with several ends. `step_m`: length of a range sample.
void count_ends(const Transmission& transmission, const RefractedEndsTransmission& found, double step_m,
                PingSums& sums) {
  PingCounts& counts = sums.counts;
  const std::size_t receivers = found.apparent.seen.size() - 1;
  counts.refraction.at_limit += found.at_limit;
  for (const ApparentSurface& surface_mesh : found.apparent.seen)
    add_counts(counts.refraction, surface_mesh, transmission);
  if (transmission.loaded_scene().surface_mesh) counts.refined_facets += found.facets();
  sums.add_finer_relief(transmission, found.history, found.apparent.seabed.mesh, step_m);
  counts.footprints += receivers * found.history.shared.facets.size();
  counts.pieces += receivers * found.history.shared.pieces.size();
}

/// Adds the reference of a separate receiver in stratified water.
void add_refracted_separate_reference(const EchoContribution& plan, const Transmission& transmission,
                                      PingSums& sums) {
  const RefractedEndsTransmission found = certify_refracted_pair_transmission(transmission);
  count_ends(transmission, found, transmission.sample_length_m(), sums);
  sums.counts.tubes += found.history.transmit.tubes.size() + found.history.receive.tubes.size();
  for (const std::size_t s : plan.sensors) {
    sums.add(transmission, s, found.sensors.front().certified);
    add_labels(transmission, s, TransmissionSurface(transmission.loaded_scene()), found.apparent.seabed.mesh,
               found.history, sums);
  }
}

/// Adds the reference in stratified water. It chooses its own apparent surface.
void add_refracted_reference(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  const RefractedTransmission found = certify_refracted_transmission(transmission, plan.sensors);
  PingCounts& counts = sums.counts;
  counts.refraction.at_limit += found.at_limit;
  add_counts(counts.refraction, *found.surface_mesh.apparent(), transmission);
  if (transmission.loaded_scene().surface_mesh)
    counts.refined_facets += found.surface_mesh.mesh().facets.size();
  sums.add_finer_relief(transmission, found.history, found.surface_mesh.mesh(),
                        transmission.sample_length_m());
  counts.candidates += found.candidates;
  counts.tubes += found.history.tubes.tubes.size();
  counts.footprints += found.history.footprints.footprints.size();
  counts.pieces += found.history.footprints.pieces.size();
  for (std::size_t k = 0; k < plan.sensors.size(); ++k) {
    sums.add(transmission, plan.sensors[k], found.sensors[k].certified);
    add_labels(transmission, plan.sensors[k], found.surface_mesh, found.surface_mesh.mesh(), found.history,
               sums);
  }
}

void add_refracted_receiver_pair_reference(const EchoContribution& plan, const Transmission& transmission,
                                           PingSums& sums) {
  for (const std::size_t s : plan.sensors) {
    ReceiverPairRows rows(transmission, s);
    for (std::uint32_t fan = 0; fan < std::uint32_t(transmission.beams(s)); ++fan) {
      const RefractedEndsTransmission found =
          certify_refracted_receiver_pair_transmission(transmission, s, fan);
      count_ends(transmission, found, transmission.samples(s).step_m, sums);
      sums.counts.tubes += 3 * found.history.transmit.tubes.size();
      rows.set(fan, found.sensors.front().certified);
      add_labels_of_receiver_pair(transmission, s, fan, found.apparent.seabed.mesh, found.history, sums);
    }
    rows.add_to(sums, transmission, s, 1);
  }
}

/// Adds no energies. Counts the facets and the relief of the surface that the following parts share.
void count_surface(const EchoContribution&, const Transmission& transmission, PingSums& sums) {
  const TransmissionSurface& surface_mesh = transmission.surface_mesh();
  if (surface_mesh.apparent() != nullptr)
    add_counts(sums.counts.refraction, *surface_mesh.apparent(), transmission);
  if (transmission.loaded_scene().surface_mesh)
    sums.counts.refined_facets += surface_mesh.mesh().facets.size();
}

/// The facets that transmitter and separate receivers see, and their common visibility. In stratified water
/// each end of a separate receiver sees an apparent surface of its own.
class CommonSurface {
 public:
  CommonSurface(const EchoContribution& plan, const Transmission& transmission, PingSums& sums)
      : plan_(plan), transmission_(transmission), counts_(sums.counts.refraction) {
    if (!plan.has_surface_per_end) return;
    pair_.emplace(refracted_pair_of(transmission));
    loaded_.emplace(transmission.loaded_scene());
    for (const ApparentSurface* surface_mesh : {&pair_->apparent.transmit, &pair_->apparent.receive})
      add_counts(counts_, *surface_mesh, transmission);
    if (transmission.loaded_scene().surface_mesh) sums.counts.refined_facets += mesh().facets.size();
  }
  /// Returns the mesh of the facets of its histories.
  const FacetMesh& mesh() const { return pair_ ? pair_->apparent.mesh : transmission_.surface_mesh().mesh(); }
  /// Returns the surface by which a sensor's echo model is made.
  const TransmissionSurface& model_surface() const {
    return loaded_ ? *loaded_ : transmission_.surface_mesh();
  }
  /// Replaces the baselines by those of the apparent surfaces.
  void set_baselines(BeamPatterns& patterns) const {
    if (pair_) patterns.baselines = refracted_receiver_baselines(transmission_, *pair_);
  }
  /// Calls `take` with the common visibility of the transmitter and a separate receiver, in portions.
  template <class Take>
  void trace(const Take& take) const {
    const auto counted = [&](const BistaticHistory& history) {
      count(history.bistatic);
      take(history);
    };
    if (!plan_.by_rays)
      counted(pair_ ? trace_both(transmission_, *pair_) : transmission_.trace_both());
    else if (pair_)
      trace_rays_of_both(transmission_, *pair_, rays_of(transmission_), counted);
    else
      transmission_.trace_rays_of_both(*RaySurface(transmission_), rays_of(transmission_), counted);
  }
  /// Returns the common visibility of a fan's transmitter and the two receivers of its receiver pair.
  ReceiverPairHistory trace(std::size_t s, std::uint32_t fan, const ReceiverBaseline& receiver_pair) const {
    if (!pair_) return transmission_.trace_receiver_pair(s, fan, receiver_pair);
    ReceiverPairHistory history = trace_receiver_pair(transmission_, *pair_, fan, receiver_pair);
    count(history.bistatic_upper);
    count(history.bistatic_lower);
    return history;
  }

 private:
  void count(const std::vector<BistaticFacet>& facets) const {
    for (const BistaticFacet& facet : facets)
      counts_.largest_travel_path_error_m = std::max(counts_.largest_travel_path_error_m, facet.misfit_m);
  }

  const EchoContribution& plan_;
  const Transmission& transmission_;
  ApparentMapCounts& counts_;
  std::optional<RefractedPair> pair_;
  std::optional<TransmissionSurface> loaded_;
};

void add_separate_receiver(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  const CommonSurface surface(plan, transmission, sums);
  const FacetMesh& mesh = surface.mesh();
  for (const std::size_t s : plan.sensors) {
    const Sensor& sensor = transmission.sensor(s);
    const auto add = [&](const BistaticHistory& history) {
      sums.add_finer_relief(transmission, history, mesh, sensor.samples().step_m);
      SensorModel model(transmission, surface.model_surface(), s);
      model.model.material = mesh.material;
      const Echo echo = transmission.echo(history, s, model.model);
      if (plan.tolerance) {
        const std::vector<std::uint32_t> fans = sensor.fan_of_tube(transmission.number());
        sums.add(transmission, s,
                 certify_echo(mesh, history, transmission.beams_by_fans(s, fans), transmission.samples(s),
                              model.model, echo, *plan.tolerance));
      } else {
        sums.add(transmission, s, 1, echo.energy);
      }
      add_labels(transmission, s, model.model, mesh, history, sums);
      sums.counts.tubes += history.transmit.tubes.size() + history.receive.tubes.size();
      sums.counts.footprints += history.shared.facets.size();
      sums.counts.pieces += history.shared.pieces.size();
      sums.counts.hits += history.hits.size();
    };
    surface.trace([&](const BistaticHistory& history) { sums.as_echo([&] { add(history); }); });
  }
}

void add_receiver_pairs(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  const CommonSurface surface(plan, transmission, sums);
  const FacetMesh& mesh = surface.mesh();
  const double unit_m = transmission.scene().grid.unit_m();
  for (const std::size_t s : plan.sensors) {
    const RangeSamples samples = transmission.samples(s);
    SensorModel model(transmission, surface.model_surface(), s);
    model.model.material = mesh.material;
    surface.set_baselines(model.patterns);
    ReceiverPairRows rows(transmission, s);
    for (std::uint32_t fan = 0; fan < model.patterns.baselines.size(); ++fan) {
      const ReceiverBaseline& receiver_pair = model.patterns.baselines[fan];
      const ReceiverPairHistory history = surface.trace(s, fan, receiver_pair);
      sums.as_echo([&] {
        const ReceiverPairEcho echo =
            integrate_receiver_pair_echo(history, receiver_pair, fan, fan, samples, model.model);
        if (plan.tolerance) {
          const BeamPatterns patterns = patterns_of_fan(model.patterns, fan, history.upper.tubes.size());
          EchoModel own = model.model;
          own.patterns = &patterns;
          rows.set(fan, certify_receiver_pair_echo(mesh, history, unit_m, receiver_pair, samples, own, echo,
                                                   *plan.tolerance));
        } else {
          rows.set(fan, echo);
        }
        add_labels_of_receiver_pair(transmission, s, fan, model.model, mesh, history, receiver_pair, sums);
        sums.add_finer_relief(transmission,
                              BistaticHistory{history.transmit, history.upper, unit_m, history.by_upper,
                                              history.bistatic_upper},
                              mesh, samples.step_m);
        sums.counts.tubes += 3 * history.transmit.tubes.size();
        sums.counts.footprints += history.by_upper.facets.size() + history.by_lower.facets.size();
        sums.counts.pieces += history.pieces();
      });
    }
    rows.add_to(sums, transmission, s, 1);
  }
}

/// Adds the echoes of one history for the sensors of a contribution.
void add_history(const EchoContribution& plan, const Transmission& transmission, const History& history,
                 PingSums& sums) {
  const TransmissionSurface& surface_mesh = transmission.surface_mesh();
  sums.as_echo([&] {
    for (const std::size_t s : plan.sensors) {
      if (sums.chosen(s).pings == 0) continue;
      const Sensor& sensor = transmission.sensor(s);
      const SensorModel model = transmission.model(s);
      sums.with_echo(transmission, history, s, model.model, [&](const Echo& echo) {
        if (plan.tolerance)
          sums.add(transmission, s,
                   certify_echo(surface_mesh.mesh(), surface_mesh.tree(), history,
                                transmission.request().visibility, sensor.beam_of_tube(transmission.number()),
                                transmission.samples(s), model.model, echo, *plan.tolerance));
        else
          sums.add(transmission, s, 1, echo.energy, echo.nonzero);
      });
      add_labels(transmission, s, model.model, surface_mesh.mesh(), history, sums);
    }
    sums.add_finer_relief(transmission, history, surface_mesh.mesh(), transmission.sample_length_m());
    sums.counts.tubes += history.tubes.tubes.size();
    sums.counts.footprints += history.footprints.footprints.size();
    sums.counts.pieces += history.footprints.pieces.size();
    sums.counts.hits += history.hits.size();
  });
}

void add_surface(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  if (!plan.by_rays) {
    const History& history = traced(transmission, sums);
    sums.counts.candidates += sums.seen->candidates;
    return add_history(plan, transmission, history, sums);
  }
  History history;
  history.tubes = transmission.tubes();
  history.grid_unit_m = transmission.scene().grid.unit_m();
  const RayGuide guide = guide_of(transmission);
  trace_rays(
      *RaySurface(transmission), history, rays_of(transmission),
      transmission.sensor(transmission.first()).beam_of_tube(transmission.number()),
      [&] { add_history(plan, transmission, history, sums); }, nullptr, &guide);
}

/// Adds paths with different eigenrays to and from a place. The computation uses tubes, also for the ray
/// engine.
void add_mixed_eigenrays(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  const ApparentSurface& surface_mesh = *transmission.surface_mesh().apparent();
  const auto take = [&](const BistaticHistory& history) {
    for (const std::size_t s : plan.sensors) {
      SensorModel model(transmission, TransmissionSurface(transmission.loaded_scene()), s);
      model.model.material = surface_mesh.part_material;
      sums.add(transmission, s, 1, transmission.echo(history, s, model.model).energy);
      add_labels_of_mixed_eigenrays(transmission, s, model.model, surface_mesh, history, sums);
    }
    sums.counts.pieces += history.shared.pieces.size();
  };
  trace_mixed_eigenrays(surface_mesh, transmission.surface_mesh().tree(), transmission.scene().grid,
                        transmission.request().visibility, transmission.tubes(),
                        [&](const BistaticHistory& history) { sums.as_echo([&] { take(history); }); });
}

}  // namespace

std::vector<bool> wanted_tubes(const Transmission& transmission, const PingSums& sums) {
  std::vector<bool> wanted;
  if (transmission.request().reference_tolerance) return wanted;
  for (const std::size_t s : transmission.group().sensors) {
    const ChosenEchoes& chosen = sums.chosen(s);
    if (chosen.pings == 0) continue;
    const Sensor& sensor = transmission.sensor(s);
    // An edge changes energies of neighbouring tubes.
    if (chosen.all_beams || sensor.has_patterns() || has_fresnel_borders(sensor)) return {};
    const std::vector<std::uint32_t>& beams = sensor.beams_of_transmission(transmission.number());
    const std::vector<std::uint32_t>& beam_of_tube = sensor.beam_of_tube(transmission.number());
    wanted.resize(beam_of_tube.size());
    for (std::size_t tube = 0; tube < wanted.size(); ++tube)
      if (chosen.place_of(beams[beam_of_tube[tube]])) wanted[tube] = true;
  }
  return wanted;
}

const History& traced(const Transmission& transmission, PingSums& sums) {
  std::vector<bool> wanted = wanted_tubes(transmission, sums);
  const bool is_this =
      sums.seen && sums.seen->group == &transmission.group() && sums.seen->number == transmission.number();
  const bool same = sums.seen && (is_this || !transmission.loaded_scene().has_surface_per_transmission()) &&
                    sums.seen->wanted == wanted && sums.seen->history.tubes == transmission.tubes();
  if (!same) {
    sums.seen.reset();
    PingSums::Seen seen;
    seen.group = &transmission.group();
    seen.number = transmission.number();
    seen.history =
        transmission.trace(&seen.candidates, transmission.request().binning != Binning::exact, wanted);
    seen.wanted = std::move(wanted);
    sums.seen = std::move(seen);
  }
  return sums.seen->history;
}

RunRequest with_needs(RunRequest request, std::span<const std::vector<EchoContribution>> plan) {
  for (const std::vector<EchoContribution>& of_group : plan)
    for (const EchoContribution& contribution : of_group) {
      request.visibility.corner_names |= contribution.needs_corner_names;
      request.visibility.open_water |= contribution.needs_open_water;
    }
  return request;
}

std::vector<EchoContribution> contributions_to(const Survey& survey, const RunRequest& request,
                                               const SharedTransmissions& group) {
  const auto sensor = [&](std::size_t s) -> const Sensor& { return *survey.sensors[s].sensor; };
  const auto those = [&](const auto& wanted) {
    std::vector<std::size_t> sensors;
    std::ranges::copy_if(group.sensors, std::back_inserter(sensors), wanted);
    return sensors;
  };
  const auto is_pair = [&](std::size_t s) { return sensor(s).has_receiver_pair(); };
  const auto is_single = [&](std::size_t s) { return !is_pair(s); };
  const auto has_paths = [&](std::size_t s) {
    return path_settings(survey.scene, sensor(s).frequency_khz()).has_value();
  };

  std::vector<EchoContribution> plan;
  const bool rays = request.engine == Engine::ray, certified = request.reference_tolerance.has_value(),
             refracted = survey.scene.water->refracts(),
             separate = sensor(group.sensors.front()).has_separate_receiver(),
             surface_per_end = refracted && separate;
  const auto add = [&](std::vector<std::size_t> sensors, decltype(EchoContribution::add) function) {
    if (!sensors.empty())
      plan.push_back({std::move(sensors), function, request.reference_tolerance, rays, surface_per_end});
  };
  const bool direct = is_order_wanted(survey.scene, 1);
  const auto add_targets = [&] {
    if (direct && has_water_targets(survey.scene.description)) add(group.sensors, add_water_targets);
  };
  if (request.own_engine) {
    add(group.sensors, add_own_engine);
    add_targets();
    return plan;
  }
  add(those([&](std::size_t s) { return has_paths(s) && is_single(s); }), add_paths);
  add(those([&](std::size_t s) { return has_paths(s) && is_pair(s); }), add_receiver_pair_paths);
  // Receivers of a pair have a visibility of their own if both are tubes from exact apexes. Otherwise both
  // use the history of the transmitter.
  const bool pairs_are_bistatic =
      separate || (request.engine == Engine::tube && request.binning == Binning::exact);
  const std::vector<std::size_t> pairs = pairs_are_bistatic ? those(is_pair) : std::vector<std::size_t>(),
                                 others = pairs_are_bistatic ? those(is_single) : group.sensors;
  if (direct && refracted && certified) {
    add(others, separate ? add_refracted_separate_reference : add_refracted_reference);
    add(pairs, add_refracted_receiver_pair_reference);
  } else {
    if (!surface_per_end && (direct || (!refracted && std::ranges::any_of(group.sensors, has_paths))))
      add(group.sensors, count_surface);
    if (direct) {
      add(pairs, add_receiver_pairs);
      add(others, separate ? add_separate_receiver : add_surface);
      if (refracted && !separate) add(those(is_single), add_mixed_eigenrays);
      if (const auto fresnel = those([&](std::size_t s) { return has_fresnel_borders(sensor(s)); });
          !fresnel.empty()) {
        add(fresnel, separate ? add_fresnel_pair_borders : add_fresnel_borders);
        plan.back().needs_corner_names = !separate;
      }
    }
  }
  if (direct && survey.scene.volume.any()) {
    add(group.sensors, separate ? add_separate_volume : add_volume);
    plan.back().needs_open_water =
        refracted || separate ||
        needs_open_water(survey.scene.volume, std::ranges::any_of(group.sensors, [&](std::size_t s) {
                           return sensor(s).has_patterns();
                         }));
  }
  add_targets();
  add(those([&](std::size_t s) { return sensor(s).signals() != nullptr; }), add_signals);
  if (!request.gradient.empty()) {
    add(group.sensors, add_gradients);
    plan.back().needs_corner_names = true;
    add(those([&](std::size_t s) { return sensor(s).signals() != nullptr; }), add_signal_gradients);
  }
  return plan;
}

}  // namespace tubefoot
