// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/echo_parts.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "engine/certified/receiver_pair_reference.hpp"
#include "engine/rays/ray_engine.hpp"
#include "engine/visibility/mixed_eigenrays.hpp"
#include "run/label_parts.hpp"
#include "run/own_engine_part.hpp"
#include "run/path_parts.hpp"
#include "run/paths.hpp"
#include "run/receiver_pair_rows.hpp"
#include "run/refracted_reference.hpp"
#include "run/refraction.hpp"
#include "run/signals.hpp"
#include "run/transmission_images.hpp"
#include "run/transmission_rays.hpp"

// This file implements the parts of a transmission's echoes. They are direct echoes from one surface,
// separate receivers, receiver pairs, mixed-eigenray returns, references in refracting water, paths,
// signals, and engines of the user. A table of flags selects the parts of a run.

namespace tubefoot {
namespace {

/// Returns whether each receiver of a receiver pair has a visibility of its own. Otherwise both use the
/// history of the transmitter.
bool receiver_pairs_are_bistatic(const RunRequest& request) {
  return request.engine == Engine::tube && request.binning == Binning::exact;
}

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

/// Adds the reference of a separate receiver.
void add_refracted_pair_reference(const Transmission& transmission, PingSums& sums) {
  const RefractedEndsTransmission found = certify_refracted_pair_transmission(transmission);
  count_ends(transmission, found, transmission.sample_length_m(), sums);
  sums.counts.tubes += found.history.transmit.tubes.size() + found.history.receive.tubes.size();
  sums.add(transmission, transmission.first(), found.sensors.front().certified);
  add_labels(transmission, transmission.first(), TransmissionSurface(transmission.loaded_scene()),
             found.apparent.seabed.mesh, found.history, sums);
}

/// Adds the reference through refracting water, which chooses its own apparent surface.
void add_refracted_reference(const Transmission& transmission, PingSums& sums) {
  if (transmission.has_separate_receiver()) return add_refracted_pair_reference(transmission, sums);
  const RefractedTransmission found = certify_refracted_transmission(transmission);
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
  for (std::size_t k = 0; k < transmission.group().sensors.size(); ++k) {
    if (transmission.sensor(transmission.group().sensors[k]).has_receiver_pair()) continue;
    sums.add(transmission, transmission.group().sensors[k], found.sensors[k].certified);
    add_labels(transmission, transmission.group().sensors[k], found.surface_mesh, found.surface_mesh.mesh(),
               found.history, sums);
  }
}

void add_refracted_receiver_pair_reference(const Transmission& transmission, PingSums& sums) {
  for (const std::size_t s : transmission.group().sensors) {
    if (!transmission.sensor(s).has_receiver_pair()) continue;
    ReceiverPairRows rows(transmission, s);
    for (std::uint32_t fan = 0; fan < std::uint32_t(transmission.beams(s)); ++fan) {
      const RefractedEndsTransmission found =
          certify_refracted_receiver_pair_transmission(transmission, s, fan);
      count_ends(transmission, found, transmission.sensor(s).samples().step_m, sums);
      sums.counts.tubes += 3 * found.history.transmit.tubes.size();
      rows.set(fan, found.sensors.front().certified);
      add_labels_of_receiver_pair(transmission, s, fan, found.apparent.seabed.mesh, found.history, sums);
    }
    rows.add_to(sums, transmission, s, 1);
  }
}

/// `mesh`: mesh of the history's facets.
void add_both(const Transmission& transmission, const BistaticHistory& history, const FacetMesh& mesh,
              PingSums& sums) {
  sums.as_echo([&] {
    const std::size_t s = transmission.first();
    sums.add_finer_relief(transmission, history, mesh, transmission.sensor(s).samples().step_m);
    SensorModel model(transmission, TransmissionSurface(transmission.loaded_scene()), s);
    model.model.material = mesh.material;
    const Echo echo = transmission.echo(history, s, model.model);
    if (const auto tolerance = transmission.request().reference_tolerance) {
      const std::vector<std::uint32_t> fans = transmission.sensor(s).fan_of_tube(transmission.number());
      sums.add(transmission, s,
               certify_echo(mesh, history, transmission.beams_by_fans(s, fans),
                            transmission.sensor(s).samples(), model.model, echo, *tolerance));
    } else {
      sums.add(transmission, s, 1, echo.energy);
    }
    add_labels(transmission, s, model.model, mesh, history, sums);
    sums.counts.tubes += history.transmit.tubes.size() + history.receive.tubes.size();
    sums.counts.footprints += history.shared.facets.size();
    sums.counts.pieces += history.shared.pieces.size();
    sums.counts.hits += history.hits.size();
  });
}

/// Adds no energies. Counts the facets and the relief of the surface that the following parts share.
void count_surface(const Transmission& transmission, PingSums& sums) {
  const TransmissionSurface& surface_mesh = transmission.surface_mesh();
  if (surface_mesh.apparent() != nullptr)
    add_counts(sums.counts.refraction, *surface_mesh.apparent(), transmission);
  if (transmission.loaded_scene().surface_mesh)
    sums.counts.refined_facets += surface_mesh.mesh().facets.size();
}

void add_separate_receiver(const Transmission& transmission, PingSums& sums) {
  const auto add = [&](const BistaticHistory& history) {
    add_both(transmission, history, transmission.surface_mesh().mesh(), sums);
  };
  if (transmission.request().engine == Engine::ray)
    transmission.trace_rays_of_both(*RaySurface(transmission), rays_of(transmission), add);
  else
    add(transmission.trace_both());
}

/// `mesh`: mesh of the histories' facets. `trace(fan, receiver pair)` makes the histories.
template <class Trace>
void add_receiver_pair(const Transmission& transmission, std::size_t s, const SensorModel& model,
                       const FacetMesh& mesh, PingSums& sums, const Trace& trace) {
  const double unit_m = transmission.scene().grid.unit_m();
  EchoModel on_mesh = model.model;
  on_mesh.material = mesh.material;
  ReceiverPairRows rows(transmission, s);
  for (std::uint32_t fan = 0; fan < model.patterns.baselines.size(); ++fan) {
    const ReceiverBaseline& receiver_pair = model.patterns.baselines[fan];
    const ReceiverPairHistory history = trace(fan, receiver_pair);
    sums.as_echo([&] {
      const ReceiverPairEcho echo = integrate_receiver_pair_echo(history, receiver_pair, fan, fan,
                                                                 transmission.sensor(s).samples(), on_mesh);
      if (const auto tolerance = transmission.request().reference_tolerance) {
        const BeamPatterns patterns = patterns_of_fan(model.patterns, fan, history.upper.tubes.size());
        EchoModel own = on_mesh;
        own.patterns = &patterns;
        rows.set(fan, certify_receiver_pair_echo(mesh, history, unit_m, receiver_pair,
                                                 transmission.sensor(s).samples(), own, echo, *tolerance));
      } else {
        rows.set(fan, echo);
      }
      add_labels_of_receiver_pair(transmission, s, fan, on_mesh, mesh, history, receiver_pair, sums);
      sums.add_finer_relief(
          transmission,
          BistaticHistory{history.transmit, history.upper, unit_m, history.by_upper, history.bistatic_upper},
          mesh, transmission.sensor(s).samples().step_m);
      sums.counts.tubes += 3 * history.transmit.tubes.size();
      sums.counts.footprints += history.by_upper.facets.size() + history.by_lower.facets.size();
      sums.counts.pieces += history.pieces();
    });
  }
  rows.add_to(sums, transmission, s, 1);
}

void add_refracted_separate_receiver(const Transmission& transmission, PingSums& sums) {
  const RefractedPair pair = refracted_pair_of(transmission);
  const FacetMesh& mesh = pair.apparent.mesh;
  ApparentMapCounts& counts = sums.counts.refraction;
  for (const ApparentSurface* surface_mesh : {&pair.apparent.transmit, &pair.apparent.receive})
    add_counts(counts, *surface_mesh, transmission);
  if (transmission.loaded_scene().surface_mesh) sums.counts.refined_facets += mesh.facets.size();
  const auto keep_misfit = [&](const std::vector<BistaticFacet>& facets) {
    for (const BistaticFacet& facet : facets)
      counts.largest_travel_path_error_m = std::max(counts.largest_travel_path_error_m, facet.misfit_m);
  };
  const std::size_t s = transmission.first();
  if (transmission.sensor(s).has_receiver_pair()) {
    SensorModel model(transmission, TransmissionSurface(transmission.loaded_scene()), s);
    model.patterns.baselines = refracted_receiver_baselines(transmission, pair);
    return add_receiver_pair(
        transmission, s, model, mesh, sums, [&](std::uint32_t fan, const ReceiverBaseline& receiver_pair) {
          ReceiverPairHistory history = trace_receiver_pair(transmission, pair, fan, receiver_pair);
          keep_misfit(history.bistatic_upper);
          keep_misfit(history.bistatic_lower);
          return history;
        });
  }
  const auto add = [&](const BistaticHistory& history) {
    keep_misfit(history.bistatic);
    add_both(transmission, history, mesh, sums);
  };
  if (transmission.request().engine == Engine::ray)
    trace_rays_of_both(transmission, pair, rays_of(transmission), add);
  else
    add(trace_both(transmission, pair));
}

void add_receiver_pairs(const Transmission& transmission, PingSums& sums) {
  for (const std::size_t s : transmission.group().sensors)
    if (transmission.sensor(s).has_receiver_pair())
      add_receiver_pair(transmission, s, transmission.model(s), transmission.surface_mesh().mesh(), sums,
                        [&](std::uint32_t fan, const ReceiverBaseline& receiver_pair) {
                          return transmission.trace_receiver_pair(s, fan, receiver_pair);
                        });
}

/// Adds the echoes of one history for all sensors, except receiver pairs with a visibility of their own.
template <class Add>
void add_history(const Transmission& transmission, const History& history, PingSums& sums, const Add& add) {
  sums.as_echo([&] {
    for (const std::size_t s : transmission.group().sensors)
      if (sums.chosen(s).pings > 0 && !(receiver_pairs_are_bistatic(transmission.request()) &&
                                        transmission.sensor(s).has_receiver_pair())) {
        const SensorModel model = transmission.model(s);
        sums.with_echo(transmission, history, s, model.model,
                       [&](const LitEcho& made) { add(s, model.model, made); });
        add_labels(transmission, s, model.model, transmission.surface_mesh().mesh(), history, sums);
      }
    sums.add_finer_relief(transmission, history, transmission.surface_mesh().mesh(),
                          transmission.sample_length_m());
    sums.counts.tubes += history.tubes.tubes.size();
    sums.counts.footprints += history.footprints.footprints.size();
    sums.counts.pieces += history.footprints.pieces.size();
    sums.counts.hits += history.hits.size();
  });
}

/// Returns the tubes of the selected beams. Empty if all tubes are wanted. A beam with a pattern receives
/// energy from all tubes, and the tolerance of a reference refers to all beams.
std::vector<bool> wanted_tubes(const Transmission& transmission, const PingSums& sums) {
  std::vector<bool> wanted;
  if (transmission.request().reference_tolerance) return wanted;
  for (const std::size_t s : transmission.group().sensors) {
    const ChosenEchoes& chosen = sums.chosen(s);
    if (chosen.pings == 0) continue;
    const Sensor& sensor = transmission.sensor(s);
    if (chosen.all_beams || sensor.has_patterns()) return {};
    const std::vector<std::uint32_t>& beams = sensor.beams_of_transmission(transmission.number());
    const std::vector<std::uint32_t>& beam_of_tube = sensor.beam_of_tube(transmission.number());
    wanted.resize(beam_of_tube.size());
    for (std::size_t tube = 0; tube < wanted.size(); ++tube)
      if (chosen.place_of(beams[beam_of_tube[tube]])) wanted[tube] = true;
  }
  return wanted;
}

void add_measured(const Transmission& transmission, PingSums& sums) {
  const History& history = traced(transmission, sums);
  sums.counts.candidates += sums.seen->candidates;
  add_history(transmission, history, sums, [&](std::size_t s, const EchoModel&, const LitEcho& made) {
    sums.add(transmission, s, 1, made.echo.energy, made.lit);
  });
}

void add_certified(const Transmission& transmission, PingSums& sums) {
  const History& history = traced(transmission, sums);
  sums.counts.candidates += sums.seen->candidates;
  const RunRequest& request = transmission.request();
  add_history(transmission, history, sums, [&](std::size_t s, const EchoModel& model, const LitEcho& made) {
    const Sensor& sensor = transmission.sensor(s);
    sums.add(transmission, s,
             certify_echo(transmission.surface_mesh().mesh(), transmission.surface_mesh().tree(), history,
                          request.visibility, sensor.beam_of_tube(transmission.number()), sensor.samples(),
                          model, made.echo, *request.reference_tolerance));
  });
}

/// Adds paths with different eigenrays to and from a place. The computation uses tubes, also for the ray
/// engine.
void add_mixed_eigenrays(const Transmission& transmission, PingSums& sums) {
  const ApparentSurface& surface_mesh = *transmission.surface_mesh().apparent();
  const auto take = [&](const BistaticHistory& history) {
    for (const std::size_t s : transmission.group().sensors) {
      if (transmission.sensor(s).has_receiver_pair()) continue;
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

void add_sampled(const Transmission& transmission, PingSums& sums) {
  const Scene& scene = transmission.scene();
  History history;
  history.tubes = transmission.tubes();
  history.grid_unit_m = scene.grid.unit_m();
  const auto add = [&](std::size_t s, const EchoModel&, const LitEcho& made) {
    sums.add(transmission, s, 1, made.echo.energy, made.lit);
  };
  const RayGuide guide = guide_of(transmission);
  trace_rays(
      *RaySurface(transmission), history, rays_of(transmission),
      transmission.sensor(transmission.first()).beam_of_tube(transmission.number()),
      [&] { add_history(transmission, history, sums, add); }, nullptr, &guide);
}

/// Flags that select the parts.
struct EchoFlags {
  bool own_engine, mirrors;
  bool direct;       ///< direct path to a facet and back, by a built-in engine
  bool one_surface;  ///< direct path on the single surface of the transmission
  bool certified, refracted, apart, receiver_pairs, others, rays, signals;
};

EchoFlags echo_flags_of(const Transmissions& transmissions, const SharedTransmissions& group) {
  const Survey& survey = transmissions.survey();
  const RunRequest& request = transmissions.request();
  const auto sensor = [&](std::size_t s) -> const Sensor& { return *survey.sensors[s].sensor; };
  const auto has_receiver_pair = [&](std::size_t s) { return sensor(s).has_receiver_pair(); };
  EchoFlags flags{};
  flags.own_engine = request.own_engine != nullptr;
  flags.mirrors = std::ranges::any_of(group.sensors, [&](std::size_t s) {
    return path_settings(survey.scene, sensor(s).frequency_khz()).has_value();
  });
  flags.direct = !flags.own_engine && is_order_wanted(survey.scene, 1);
  flags.certified = request.reference_tolerance.has_value();
  flags.refracted = survey.scene.water->refracts();
  flags.apart = sensor(group.sensors.front()).has_separate_receiver();
  flags.one_surface = flags.direct && !(flags.refracted && (flags.certified || flags.apart));
  // Only a transmitter in the middle of a receiver pair can represent the visibility of both receivers.
  const bool apart = receiver_pairs_are_bistatic(request) || flags.apart;
  flags.receiver_pairs = apart && std::ranges::any_of(group.sensors, has_receiver_pair);
  flags.others = !(apart && std::ranges::all_of(group.sensors, has_receiver_pair));
  flags.rays = request.engine == Engine::ray;
  flags.signals =
      std::ranges::any_of(group.sensors, [&](std::size_t s) { return sensor(s).signals() != nullptr; });
  return flags;
}

struct Row {
  EchoPart part;
  bool (*wanted)(const EchoFlags& flags);
};

using A = const EchoFlags&;
constexpr auto all_parts = std::to_array<Row>({
    {{"a custom engine", add_own_engine}, [](A a) { return a.own_engine; }},
    {{"mirror paths", add_paths}, [](A a) { return a.mirrors && !a.own_engine; }},
    {{"certified, through stratified water", add_refracted_reference},
     [](A a) { return a.direct && a.refracted && a.certified && a.others; }},
    {{"each receiver of a receiver pair, certified, through stratified water",
      add_refracted_receiver_pair_reference},
     [](A a) { return a.direct && a.refracted && a.certified && a.receiver_pairs; }},
    {{"a separate receiver, through stratified water", add_refracted_separate_receiver},
     [](A a) { return a.direct && a.refracted && a.apart && !a.certified; }},
    {{"the surface", count_surface},
     [](A a) { return a.one_surface || (a.mirrors && !a.own_engine && !a.refracted); }},
    {{"a separate receiver", add_separate_receiver},
     [](A a) { return a.one_surface && a.apart && !a.receiver_pairs; }},
    {{"each receiver of a receiver pair", add_receiver_pairs},
     [](A a) { return a.one_surface && a.receiver_pairs; }},
    {{"sampled", add_sampled}, [](A a) { return a.one_surface && !a.apart && a.others && a.rays; }},
    {{"certified", add_certified},
     [](A a) { return a.one_surface && !a.apart && a.others && !a.rays && a.certified; }},
    {{"measured", add_measured},
     [](A a) { return a.one_surface && !a.apart && a.others && !a.rays && !a.certified; }},
    {{"transmit and receive legs on different eigenrays", add_mixed_eigenrays},
     [](A a) { return a.one_surface && !a.apart && a.refracted; }},
    {{"signals of elements", add_signals}, [](A a) { return a.signals && !a.own_engine; }},
});

}  // namespace

const History& traced(const Transmission& transmission, PingSums& sums) {
  std::vector<bool> wanted = wanted_tubes(transmission, sums);
  const bool same = sums.seen && !transmission.loaded_scene().has_surface_per_transmission() &&
                    sums.seen->wanted == wanted && sums.seen->history.tubes == transmission.tubes();
  if (!same) {
    sums.seen.reset();
    PingSums::Seen seen;
    seen.history =
        transmission.trace(&seen.candidates, transmission.request().binning != Binning::exact, wanted);
    seen.wanted = std::move(wanted);
    sums.seen = std::move(seen);
  }
  return sums.seen->history;
}

std::vector<EchoPart> echo_parts(const Transmissions& transmissions, const SharedTransmissions& group) {
  const EchoFlags flags = echo_flags_of(transmissions, group);
  std::vector<EchoPart> parts;
  for (const Row& row : all_parts)
    if (row.wanted(flags)) parts.push_back(row.part);
  return parts;
}

}  // namespace tubefoot
