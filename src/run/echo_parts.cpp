// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/echo_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "engine/certified/staff_reference.hpp"
#include "engine/paths/path_echo.hpp"
#include "engine/rays/ray_engine.hpp"
#include "run/own_engine.hpp"
#include "run/paths.hpp"
#include "run/refracted_reference.hpp"
#include "run/refraction.hpp"

namespace tubefoot {
namespace {

/// Each receiver of a staff sees for itself; else by the transmitter's history, as others do.
bool staffs_are_apart(const RunRequest& request) {
  return request.engine == Engine::tube && request.binning == Binning::exact;
}

void add_own_engine(const Shot& shot, PingSums& sums) {
  for (const std::size_t s : shot.group().sensors) {
    const auto samples = static_cast<std::size_t>(shot.sensor(s).samples().count);
    std::vector<double> energy(static_cast<std::size_t>(shot.beams(s)) * samples);
    shot.request().own_engine->echo(shot, s, energy);
    sums.add(shot, s, 1, energy);
  }
}

/// Every sensor follows its own paths: its range says how far.
void add_paths_of(const Shot& shot, std::size_t s, const PathSettings& settings, PingSums& sums) {
  const Scene& scene = shot.scene();
  const Sensor& sensor = shot.sensor(s);
  TubeSet transmit = shot.tubes(), receive = shot.receive_tubes(s);
  transmit.reach = receive.reach = 2 * sensor.reach(scene.grid);
  const std::vector<std::uint32_t> fans = sensor.fan_of_tube(shot.number());
  const SensorLaw law = shot.law(s);
  PathEcho paths;
  try {
    paths = path_echo(scene.mesh, *shot.site().tree, scene.grid.unit_m(), shot.request().visibility, transmit,
                      receive, shot.beams_by_fans(s, fans), sensor.samples(), law.law, settings);
  } catch (const std::length_error& error) {
    throw InputError(sensor.description().place,
                     fmt::format("sensor '{}', paths: {}", sensor.description().name, error.what()));
  }
  const std::optional<int> only = scene.description.paths.only_order;
  for (std::size_t order = 0; order < paths.by_order.size(); ++order) {
    if (only.value_or(int(order)) != int(order)) continue;
    if (!settings.reference_tolerance) {
      sums.add(shot, s, order, paths.by_order[order].energy);
      continue;
    }
    CertifiedEcho certified{paths.by_order[order], paths.bound_by_order[order]};
    hold_against(certified, *settings.reference_tolerance);
    sums.add(shot, s, certified, order);
  }
  sums.counts.images += paths.images;
  sums.counts.arrivals += paths.arrivals;
  sums.counts.pieces += paths.shared_pieces;
}

void add_paths(const Shot& shot, PingSums& sums) {
  for (const std::size_t s : shot.group().sensors)
    if (auto settings = path_settings(shot.scene(), shot.sensor(s).frequency_khz())) {
      settings->reference_tolerance = shot.request().reference_tolerance;
      add_paths_of(shot, s, *settings, sums);
    }
}

/// Through refracting water a reference chooses its own apparent ground.
void add_refracted_reference(const Shot& shot, PingSums& sums) {
  const RefractedShot found = certify_refracted_shot(shot);
  PingCounts& counts = sums.counts;
  counts.refraction.at_limit += found.at_limit;
  add_counts(counts.refraction, *found.ground.apparent(), shot);
  counts.candidates += found.candidates;
  counts.tubes += found.history.tubes.tubes.size();
  counts.footprints += found.history.footprints.footprints.size();
  counts.pieces += found.history.footprints.pieces.size();
  for (std::size_t k = 0; k < shot.group().sensors.size(); ++k) {
    counts.refraction.unbounded += found.sensors[k].unbounded;
    sums.add(shot, shot.group().sensors[k], found.sensors[k].certified);
  }
}

/// `mesh`: that of the history's facets.
void add_both(const Shot& shot, const BistaticHistory& history, const FacetMesh& mesh, PingSums& sums) {
  sums.as_echo([&] {
    const std::size_t s = shot.first();
    sums.add_finer_relief(shot, history, mesh, shot.sensor(s).samples().step_m);
    SensorLaw law(shot, ShotGround(shot.site()), s);
    law.law.material = mesh.material;
    const Echo echo = shot.echo(history, s, law.law);
    if (const auto tolerance = shot.request().reference_tolerance) {
      const std::vector<std::uint32_t> fans = shot.sensor(s).fan_of_tube(shot.number());
      sums.add(shot, s,
               certify_echo(mesh, history, shot.beams_by_fans(s, fans), shot.sensor(s).samples(), law.law,
                            echo, *tolerance));
    } else {
      sums.add(shot, s, 1, echo.energy);
    }
    sums.counts.tubes += history.transmit.tubes.size() + history.receive.tubes.size();
    sums.counts.footprints += history.shared.facets.size();
    sums.counts.pieces += history.shared.pieces.size();
  });
}

void add_refracted_receiver_apart(const Shot& shot, PingSums& sums) {
  const RefractedPaths paths = refracted_paths_of(shot);
  StraighteningCounts& counts = sums.counts.refraction;
  for (const ApparentGround* ground : {&paths.pair.transmit, &paths.pair.receive})
    add_counts(counts, *ground, shot);
  for (const PairedFacet& facet : paths.history.paired)
    counts.largest_gap_m = std::max(counts.largest_gap_m, facet.misfit_m);
  if (shot.site().ground) sums.counts.refined_facets += paths.pair.mesh.facets.size();
  add_both(shot, paths.history, paths.pair.mesh, sums);
}

/// No energies: what the ground took that the parts after this one share.
void count_ground(const Shot& shot, PingSums& sums) {
  const ShotGround& ground = shot.ground();
  if (ground.apparent() != nullptr) add_counts(sums.counts.refraction, *ground.apparent(), shot);
  if (shot.site().ground) sums.counts.refined_facets += ground.mesh().facets.size();
}

void add_receiver_apart(const Shot& shot, PingSums& sums) {
  add_both(shot, shot.trace_both(), shot.ground().mesh(), sums);
}

void add_staff(const Shot& shot, std::size_t s, PingSums& sums) {
  const Sensor& sensor = shot.sensor(s);
  const SensorLaw law = shot.law(s);
  const auto samples = static_cast<std::size_t>(sensor.samples().count),
             beams = static_cast<std::size_t>(shot.beams(s));
  CertifiedEcho certified;
  certified.echo.energy.resize(4 * beams * samples);
  if (shot.request().reference_tolerance) certified.bound.resize(certified.echo.energy.size());
  const auto lay = [&](const std::vector<double>& rows, std::uint32_t fan, std::vector<double>& all) {
    for (std::size_t channel = 0; channel < 4; ++channel)
      std::copy_n(rows.begin() + std::ptrdiff_t(channel * samples), samples,
                  all.begin() + std::ptrdiff_t((channel * beams + fan) * samples));
  };
  for (std::uint32_t fan = 0; fan < law.patterns.fringes.size(); ++fan) {
    const StaffHistory history = shot.trace_staff(s, fan, law.patterns.fringes[fan]);
    sums.as_echo([&] {
      const StaffEcho echo = shot.echo(history, s, fan, law);
      std::vector<double> rows;
      for (const auto* row : {&echo.upper_j, &echo.lower_j, &echo.cross_real_j, &echo.cross_imag_j})
        rows.insert(rows.end(), row->begin(), row->end());
      if (const auto tolerance = shot.request().reference_tolerance) {
        CertifiedEcho found = certify_staff_echo(shot.ground().mesh(), history, shot.scene().grid.unit_m(),
                                                 law.patterns.fringes[fan], fan, fan, sensor.samples(),
                                                 law.law, echo, *tolerance);
        rows = found.echo.energy;
        lay(found.bound, fan, certified.bound);
        certified.bins_over += found.bins_over;
        if (found.worst_ratio > certified.worst_ratio) {
          certified.worst_ratio = found.worst_ratio;
          certified.worst_beam = int(fan);  // of whichever channel
          certified.worst_sample = found.worst_sample;
        }
      }
      lay(rows, fan, certified.echo.energy);
      sums.add_finer_relief(
          shot,
          BistaticHistory{history.transmit, history.upper, shot.scene().grid.unit_m(), history.by_upper},
          shot.ground().mesh(), sensor.samples().step_m);
      sums.counts.tubes += 3 * history.transmit.tubes.size();
      sums.counts.footprints += history.by_upper.facets.size() + history.by_lower.facets.size();
      sums.counts.pieces += history.pieces();
    });
  }
  if (certified.bound.empty())
    sums.add(shot, s, 1, certified.echo.energy);
  else
    sums.add(shot, s, certified);
}

void add_staffs(const Shot& shot, PingSums& sums) {
  for (const std::size_t s : shot.group().sensors)
    if (shot.sensor(s).has_staff()) add_staff(shot, s, sums);
}

/// What all sensors that do not see for themselves hear of one history.
template <class Add>
void add_history(const Shot& shot, const History& history, PingSums& sums, const Add& add) {
  sums.as_echo([&] {
    for (const std::size_t s : shot.group().sensors)
      if (!(staffs_are_apart(shot.request()) && shot.sensor(s).has_staff())) {
        const SensorLaw law = shot.law(s);
        add(s, law.law, shot.echo(history, s, law.law));
      }
    sums.add_finer_relief(shot, history, shot.ground().mesh(), shot.sample_length_m());
    sums.counts.tubes += history.tubes.tubes.size();
    sums.counts.footprints += history.footprints.footprints.size();
    sums.counts.pieces += history.footprints.pieces.size();
    sums.counts.hits += history.hits.size();
  });
}

History traced(const Shot& shot, PingSums& sums) {
  std::size_t candidates = 0;
  History history = shot.trace(&candidates, shot.request().binning != Binning::exact);
  sums.counts.candidates += candidates;
  return history;
}

void add_measured(const Shot& shot, PingSums& sums) {
  const History history = traced(shot, sums);
  add_history(shot, history, sums,
              [&](std::size_t s, const EchoLaw&, const Echo& echo) { sums.add(shot, s, 1, echo.energy); });
}

void add_certified(const Shot& shot, PingSums& sums) {
  const History history = traced(shot, sums);
  const RunRequest& request = shot.request();
  add_history(shot, history, sums, [&](std::size_t s, const EchoLaw& law, const Echo& echo) {
    const Sensor& sensor = shot.sensor(s);
    sums.add(shot, s,
             certify_echo(shot.ground().mesh(), shot.ground().tree(), history, request.visibility,
                          sensor.beam_of_tube(shot.number()), sensor.samples(), law, echo,
                          *request.reference_tolerance));
  });
}

/// Tells pings of a survey apart.
std::uint64_t label_of(const Shot& shot) {
  std::uint64_t label = shot.ping();
  for (const SharedShots& group : shot.survey().shots) {
    if (&group == &shot.group()) break;
    label += shot.survey().fleet->pings(group);
  }
  return label + (std::uint64_t(shot.number()) << 40);
}

void add_sampled(const Shot& shot, PingSums& sums) {
  const Scene& scene = shot.scene();
  std::optional<RayScene> own;
  if (shot.ground().is_own()) own.emplace(shot.ground().mesh(), scene.grid);
  RaySettings settings = shot.request().rays;
  // Every ping draws its own sample, so that errors of neighbours are independent.
  settings.seed += 0x9e3779b97f4a7c15u * label_of(shot);
  History history;
  history.tubes = shot.tubes();
  history.grid_unit_m = scene.grid.unit_m();
  const auto add = [&](std::size_t s, const EchoLaw&, const Echo& echo) {
    sums.add(shot, s, 1, echo.energy);
  };
  trace_rays(own ? *own : shot.site().rays(), history, settings,
             shot.sensor(shot.first()).beam_of_tube(shot.number()),
             [&] { add_history(shot, history, sums, add); });
}

/// What decides between the parts.
struct Asked {
  bool own_engine, mirrors;
  bool direct;      ///< the way to a facet and straight back, by a built-in engine
  bool one_ground;  ///< that, on the shot's one ground
  bool certified, refracted, apart, staffs, others, rays;
};

Asked asked_of(const Shots& shots, const SharedShots& group) {
  const Survey& survey = shots.survey();
  const RunRequest& request = shots.request();
  const auto sensor = [&](std::size_t s) -> const Sensor& { return *survey.sensors[s].sensor; };
  const auto has_staff = [&](std::size_t s) { return sensor(s).has_staff(); };
  Asked asked{};
  asked.own_engine = request.own_engine != nullptr;
  asked.mirrors = std::ranges::any_of(group.sensors, [&](std::size_t s) {
    return path_settings(survey.scene, sensor(s).frequency_khz()).has_value();
  });
  asked.direct = !asked.own_engine && survey.scene.description.paths.only_order.value_or(1) == 1;
  asked.certified = request.reference_tolerance.has_value();
  asked.refracted = survey.scene.water->refracts();
  asked.apart = sensor(group.sensors.front()).has_receiver_apart();
  asked.one_ground = asked.direct && !(asked.refracted && (asked.certified || asked.apart));
  asked.staffs = staffs_are_apart(request) && std::ranges::any_of(group.sensors, has_staff);
  asked.others = !(staffs_are_apart(request) && std::ranges::all_of(group.sensors, has_staff));
  asked.rays = request.engine == Engine::ray;
  return asked;
}

struct Row {
  EchoPart part;
  bool (*wanted)(const Asked& asked);
};

using A = const Asked&;
constexpr auto table = std::to_array<Row>({
    {{"an engine of one's own", add_own_engine}, [](A a) { return a.own_engine; }},
    {{"paths over mirrors", add_paths}, [](A a) { return a.mirrors && !a.own_engine; }},
    {{"certified, through refracting water", add_refracted_reference},
     [](A a) { return a.direct && a.refracted && a.certified; }},
    {{"a receiver apart, through refracting water", add_refracted_receiver_apart},
     [](A a) { return a.direct && a.refracted && a.apart && !a.certified; }},
    {{"the ground", count_ground}, [](A a) { return a.one_ground; }},
    {{"a receiver apart", add_receiver_apart}, [](A a) { return a.one_ground && a.apart; }},
    {{"each receiver of a staff", add_staffs}, [](A a) { return a.one_ground && !a.apart && a.staffs; }},
    {{"sampled", add_sampled}, [](A a) { return a.one_ground && !a.apart && a.others && a.rays; }},
    {{"certified", add_certified},
     [](A a) { return a.one_ground && !a.apart && a.others && !a.rays && a.certified; }},
    {{"measured", add_measured},
     [](A a) { return a.one_ground && !a.apart && a.others && !a.rays && !a.certified; }},
});

}  // namespace

std::vector<EchoPart> echo_parts(const Shots& shots, const SharedShots& group) {
  const Asked asked = asked_of(shots, group);
  std::vector<EchoPart> parts;
  for (const Row& row : table)
    if (row.wanted(asked)) parts.push_back(row.part);
  return parts;
}

}  // namespace tubefoot
