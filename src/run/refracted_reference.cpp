// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/refracted_reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/certified/bistatic_reference.hpp"
#include "engine/visibility/bistatic_history.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "run/refraction.hpp"
#include "run/transmission.hpp"

// This file computes certified echoes in refracting water. It refines the apparent surface of a transmission
// until the certified bounds reach the requested tolerance, or until a limit of facets is reached
// (docs/environment.md).

namespace tubefoot {
namespace {

constexpr int most_tries = 6;
constexpr double most_refined_facets =
    24'000;  // limit for the last refinement: about half a minute of one core
constexpr double most_facets_of_paths = 6'000;  // lower, because each pair of images has bounds of its own
constexpr std::size_t few_facets = 1'500;       // surfaces of so few facets cost almost no time
constexpr double coarsest = 0.1;                // tolerance for which the first surface is made
constexpr double least_worth = 1.2;
// limit of successive halvings of the mapping tolerances until facets are cut
constexpr int most_halvings = 30;

/// The seabed as the given sensors see it.
struct CertifiedView {
  const TransmissionApparentMap& map;
  const std::vector<std::size_t>& sensors;
};

RefractedTransmission certify(const Transmission& transmission, const CertifiedView& seen,
                              ApparentSurface apparent) {
  const Scene& scene = transmission.scene();
  const VisibilityOptions& options = transmission.request().visibility;
  const std::vector<FacetId> parent = apparent.refined.parent;
  seen.map.seabed().name_by_scene(apparent);
  RefractedTransmission found{
      TransmissionSurface(transmission.loaded_scene(), std::move(apparent)), {}, 0, {}, false};
  const FacetMesh& mesh = found.surface_mesh.mesh();
  const MappedSeabed seabed{*found.surface_mesh.apparent(), found.surface_mesh.tree(),
                            seen.map.seabed().mesh(), parent, scene.grid};
  const TubeEngine engine(mesh, found.surface_mesh.tree(), scene.grid.unit_m(), options);
  found.history = engine.trace(transmission.tubes(), &found.candidates, false);
  const glm::dvec3 apex = scene.grid.to_metres(found.history.tubes.apex);
  for (const std::size_t s : seen.sensors) {
    const ApparentMap apparent_map = apparent_map_of(
        transmission.loaded_scene(), transmission.survey().sensors[s], transmission.number(), apex);
    const RayEnclosure rays(apparent_map, eigenray_options(transmission.loaded_scene()));
    const SensorModel sensor_model(transmission, found.surface_mesh, s);
    const EchoModel& model = sensor_model.model;
    const Sensor& sensor = transmission.sensor(s);
    found.sensors.push_back(certify_refracted_echo(
        seabed, rays, found.history, options, sensor.beam_of_tube(transmission.number()),
        sensor.samples(transmission.number()), model, transmission.echo(found.history, s, model),
        *transmission.request().reference_tolerance));
  }
  return found;
}

/// The ends of a transmission's sensor: transmitter and receiver, or for one fan of a receiver pair
/// transmitter, upper receiver and lower receiver.
struct CertifiedEnds {
  const EndsApparentMap& ends;
  std::size_t sensor;
  std::uint32_t fan = 0;
  const ReceiverBaseline* receiver_pair = nullptr;
};

RefractedEndsTransmission certify(const Transmission& transmission, const CertifiedEnds& seen,
                                  CommonApparentSurfaces surface_meshes) {
  const EndsApparentMap& ends = seen.ends;
  const Sensor& sensor = transmission.sensor(seen.sensor);
  const WorldGrid& grid = transmission.scene().grid;
  const VisibilityOptions& options = transmission.request().visibility;
  const double tolerance = *transmission.request().reference_tolerance;
  RefractedEndsTransmission found{std::move(surface_meshes), {}, {}, false};
  const CommonApparentSurfaces& own = found.apparent;
  const FacetMesh& mesh = own.seabed.mesh;
  SensorModel model(transmission, TransmissionSurface(transmission.loaded_scene()), seen.sensor);
  model.model.material = mesh.material;
  std::vector<SceneTree> trees;
  std::vector<RayEnclosure> rays;
  for (std::size_t end = 0; end < own.seen.size(); ++end) {
    trees.emplace_back(own.seen[end].refined.mesh, SceneTree::HeightFieldSearch::ignored);
    rays.emplace_back(ends.water(end), eigenray_options(transmission.loaded_scene()));
  }
  const auto end_of = [&](std::size_t end) {
    return BistaticEnd{own.seen[end], trees[end], own.origin[end], ends.water(end), rays[end]};
  };
  const auto seabed_of = [&](std::size_t end) {
    return BistaticSurface{mesh, own.seabed.parent, ends.seabed().mesh(), grid, end_of(0), end_of(end)};
  };
  const auto tubes_of = [&](std::size_t end) { return BistaticTubes{ends.tubes(0), ends.tubes(end)}; };
  // Sets the history, and returns the ordinary echo of a receiver.
  const auto ordinary = [&](std::size_t end, const ReceiveBeams& beams, Binning binning) {
    const ApparentPair pair{mesh, own.seen[0], own.seen[end], own.origin[0], own.origin[end]};
    try {
      found.history = trace_bistatic(pair, grid, options, ends.tubes(0), ends.tubes(end), ends.water(0),
                                     ends.water(end), ends.absorption_db_per_m());
    } catch (...) {
      rethrow_as_seen_by(transmission);
    }
    return integrate_echo(found.history, beams, transmission.samples(seen.sensor), model.model, binning);
  };
  if (seen.receiver_pair == nullptr) {
    const std::vector<std::uint32_t> fans = sensor.fan_of_tube(transmission.number());
    const ReceiveBeams beams = transmission.beams_by_fans(seen.sensor, fans);
    const Echo echo = ordinary(1, beams, transmission.request().binning);
    found.sensors.push_back(certify_refracted_echo(seabed_of(1), tubes_of(1), options, beams,
                                                   transmission.samples(seen.sensor), model.model, echo,
                                                   tolerance));
  } else {
    const BeamPatterns patterns = patterns_of_fan(model.patterns, seen.fan, ends.tubes(1).tubes.size());
    model.model.patterns = &patterns;
    const std::vector<std::uint32_t> of_tube(ends.tubes(1).tubes.size(), 0);
    std::array<Echo, 2> echoes;
    for (const std::size_t e : {1, 0}) echoes[e] = ordinary(1 + e, {1, of_tube}, Binning::exact);
    found.sensors.push_back(certify_refracted_receiver_pair(
        {seabed_of(1), seabed_of(2)}, {tubes_of(1), tubes_of(2)}, options, *seen.receiver_pair,
        sensor.samples(), model.model, echoes, tolerance));
  }
  for (ApparentSurface& surface_mesh : found.apparent.seen) ends.seabed().name_by_scene(surface_mesh);
  return found;
}

/// Quality of a certified echo. `over`: range bins whose bound is wider than requested or infinite.
/// `unbounded`: range bins without a bound. `usual_excess`: median ratio of the finite bounds to the
/// requested bounds.
struct Quality {
  std::size_t bins = 0, over = 0, unbounded = 0;
  double usual_excess = 0;

  /// Slivers at the ends of a beam have wide bounds on any surface, so that one bin in 200 may exceed the
  /// tolerance.
  bool is_wide() const { return (over - unbounded) * 200 > bins - unbounded; }
  bool is_enough() const { return unbounded == 0 && !is_wide(); }
  bool is_worth_more_than(const Quality& before) const {
    return unbounded <= before.unbounded && (double(over) * least_worth < double(before.over) ||
                                             double(unbounded) * least_worth < double(before.unbounded) ||
                                             usual_excess * least_worth < before.usual_excess);
  }
  /// Returns the factor by which the next surface is finer. Facets without a proven ray are halved, because
  /// the fineness that they need is unknown.
  double finer(double room) const {
    const double least = unbounded > 0 ? std::min(2.0, room) : least_worth;
    return is_wide() ? std::clamp(1.3 * usual_excess, least, room) : least;
  }
};
Quality quality_over(std::span<const RefractedReference> references) {
  Quality quality;
  for (const RefractedReference& reference : references) {
    quality.bins += reference.bins;
    quality.over += reference.bins_over;
    quality.unbounded += reference.unbounded;
    quality.usual_excess = std::max(quality.usual_excess, reference.usual_excess);
  }
  return quality;
}
Quality quality_of(const RefractedPathsTransmission& found) { return quality_over(found.orders); }
Quality quality_of(const auto& found) { return quality_over(found.sensors); }

/// Returns the mapping settings of the first surface.
ApparentMapSettings first_settings(const Transmission& transmission, double reach_m,
                                   ApparentMapSettings settings) {
  const double unit = transmission.scene().grid.unit_m(), sample = transmission.sample_length_m(),
               first = std::max(*transmission.request().reference_tolerance, coarsest);
  // The keys of the scene are meant for ordinary runs. The difference between straight and refracted paths
  // decreases with the travel-path error, and the change of a factor over a facet decreases with its edges.
  // The first surface is coarse, because only its result shows how many facets a tolerance needs.
  settings.travel_path_error_m =
      std::min(settings.travel_path_error_m, std::max(first * sample / 16, 2 * unit));
  settings.tolerance_db = std::min(settings.tolerance_db, 2 * first);
  settings.shortest_edge_m = std::max({sample / 16, reach_m / 20000, 64 * unit});
  return settings;
}

std::size_t facets_of(const ApparentSurface& surface_mesh) { return surface_mesh.refined.mesh.facets.size(); }
std::size_t facets_of(const CommonApparentSurfaces& surface_meshes) {
  return surface_meshes.seabed.mesh.facets.size();
}
double largest_travel_path_error_m(const CommonApparentSurfaces& surface_meshes) {
  return std::ranges::max(surface_meshes.seen, {}, &ApparentSurface::largest_travel_path_error_m)
      .largest_travel_path_error_m;
}
double largest_travel_path_error_m(const ApparentSurface& surface_mesh) {
  return surface_mesh.largest_travel_path_error_m;
}

/// Result of one refinement. Without `found`, no facet was cut. `go_on`: a further refinement may help even
/// if this one does not.
template <class Found>
struct Refinement {
  std::optional<Found> found{};
  bool go_on = false;
};

/// Refines until the bounds reach the tolerance. `finer(quality)`: returns the next refinement.
template <class Found, class Finer>
Found refined(Found first, const Finer& finer) {
  std::optional best(std::move(first));
  for (int tries = 1;; ++tries) {
    const Quality quality = quality_of(*best);
    best->at_limit = quality.is_wide();
    if (quality.is_enough() || tries == most_tries) return std::move(*best);
    Refinement<Found> next = finer(quality);
    if (next.found) {
      const Quality found = quality_of(*next.found);
      const bool worth_more = found.is_worth_more_than(quality);
      next.go_on = next.go_on || worth_more;
      if (worth_more || found.over <= quality.over) best.emplace(std::move(*next.found));
      best->at_limit = quality_of(*best).is_wide();
    }
    if (!next.go_on) return std::move(*best);
  }
}

/// Returns the largest factor by which a surface may become finer. The number of facets grows at most with
/// the square of the fineness if spreading is the reason for cutting facets.
double room_for(double most, std::size_t facets) { return std::sqrt(most / std::max(double(facets), 1.0)); }

void refine(ApparentMapSettings& settings, double by, double unit_m) {
  settings.travel_path_error_m = std::max(settings.travel_path_error_m / by, 2 * unit_m);
  settings.tolerance_db /= by;
}

/// Refines the surface until the bounds reach the tolerance. `surface_mesh_of(settings)`: maps the surface
/// for certify().
template <class Seen, class SurfaceMesh>
auto certify_until_tolerance(const Transmission& transmission, double reach_m, const Seen& seen,
                             const SurfaceMesh& surface_mesh_of) {
  const double unit = transmission.scene().grid.unit_m();
  ApparentMapSettings settings =
      first_settings(transmission, reach_m, apparent_map_settings(transmission, reach_m));
  auto first = certify(transmission, seen, surface_mesh_of(settings));
  using Found = decltype(first);
  std::size_t facets_before = first.facets();
  return refined(std::move(first), [&](const Quality& quality) -> Refinement<Found> {
    const double room = room_for(most_refined_facets, facets_before);
    if (room < least_worth) return {};
    const auto finer_surface = [&](double by) {
      refine(settings, by, unit);
      return surface_mesh_of(settings);
    };
    std::optional surface_mesh(finer_surface(quality.finer(room)));
    const auto hardly_grown = [&] {
      return double(facets_of(*surface_mesh)) < least_worth * double(facets_before);
    };
    // Facets without a proven ray may already be much finer than the mapping tolerances require.
    if (quality.unbounded > 0)
      for (int halvings = 0; hardly_grown() && halvings < most_halvings; ++halvings)
        surface_mesh.emplace(finer_surface(std::min(2.0, room)));
    const std::size_t facets = facets_of(*surface_mesh);
    // If the surface was about as fine as requested before, the next one must be finer than the surface
    // itself.
    const bool hardly_finer = hardly_grown();
    if (hardly_finer)
      settings.travel_path_error_m = std::min(settings.travel_path_error_m,
                                              std::max(largest_travel_path_error_m(*surface_mesh), 2 * unit));
    const bool as_it_was = facets == facets_before;
    facets_before = facets;
    if (as_it_was) return {{}, quality.is_wide()};
    // Many more facets may reduce bounds that a few more facets do not.
    return {certify(transmission, seen, std::move(*surface_mesh)), hardly_finer || facets < few_facets};
  });
}

}  // namespace

RefractedTransmission certify_refracted_transmission(const Transmission& transmission,
                                                     const std::vector<std::size_t>& sensors) {
  const TransmissionApparentMap map(transmission);
  return certify_until_tolerance(
      transmission, transmission.tubes().reach * transmission.scene().grid.unit_m(),
      CertifiedView{map, sensors},
      [&](const ApparentMapSettings& settings) { return map.surface_mesh(settings); });
}

namespace {

RefractedEndsTransmission certify_ends(const Transmission& transmission, const CertifiedEnds& seen) {
  return certify_until_tolerance(
      transmission, seen.ends.reach_m(), seen,
      [&](const ApparentMapSettings& settings) { return seen.ends.surface_meshes(settings); });
}

}  // namespace

RefractedEndsTransmission certify_refracted_pair_transmission(const Transmission& transmission) {
  const PairApparentMap seen(transmission);
  return certify_ends(transmission, {seen.ends(), transmission.first()});
}

RefractedEndsTransmission certify_refracted_receiver_pair_transmission(const Transmission& transmission,
                                                                       std::size_t sensor,
                                                                       std::uint32_t fan) {
  const Scene& scene = transmission.scene();
  const WorldGrid& grid = scene.grid;
  const SensorPings& pings = transmission.survey().sensors[sensor];
  const ReceiverBaseline receiver_pair =
      pings.sensor->patterns(transmission.receiver_pose(), pings.sound_speed_m_s, transmission.number())
          .baselines[fan];
  const std::vector<std::uint32_t> fans = pings.sensor->fan_of_tube(transmission.number());
  const TubeSet transmit = tubes_of_fan(transmission.tubes(), fans, fan),
                receive = transmission.has_separate_receiver()
                              ? tubes_of_fan(transmission.receive_tubes(sensor), fans, fan)
                              : transmit;
  std::vector<TubeSet> tubes{transmit};
  std::vector<ApparentMap> water{apparent_map_of(transmission.loaded_scene(), pings, transmission.number(),
                                                 grid.to_metres(transmit.apex))};
  for (const double end : {1.0, -1.0}) {
    const glm::dvec3 at_m =
        grid.to_metres(receive.apex) + end * receiver_pair.baseline_m / 2 * receiver_pair.axis;
    if (const double above = at_m.z - scene.water->surface_height_m(); above > 0)
      throw InputError(
          pings.sensor->description().place,
          fmt::format("a receiver of {} is {:.3g} m above the sea surface: lower its trajectory, "
                      "shorten 'baseline_m', or raise 'surface_height_m' of [water]",
                      transmission.name(), above));
    tubes.push_back(moved_along(receive, receiver_pair, end, grid.unit_m()));
    water.push_back(apparent_map_of(transmission.loaded_scene(), pings, transmission.number(), at_m));
  }
  const EndsApparentMap ends(transmission, std::move(tubes), std::move(water));
  return certify_ends(transmission, {ends, sensor, fan, &receiver_pair});
}

std::size_t RefractedPathsTransmission::facets() const {
  std::size_t all = 0;
  for (const ApparentSurface& surface_mesh : paths.surface_meshes) all += facets_of(surface_mesh);
  return all;
}

RefractedPathsTransmission certify_refracted_paths(const Transmission& transmission, const PathWater& water,
                                                   double reach_m,
                                                   const std::function<PathEcho(const PathWater&)>& trace) {
  const double tolerance = *transmission.request().reference_tolerance;
  PathWater finer = water;
  finer.apparent_map = first_settings(transmission, reach_m, water.apparent_map);
  const auto certified = [&] {
    RefractedPathsTransmission found{trace(finer), {}, false};
    for (std::size_t order = 0; order < found.paths.by_order.size(); ++order)
      found.orders.push_back(
          reference_of({found.paths.by_order[order], found.paths.bound_by_order[order]}, tolerance));
    return found;
  };
  RefractedPathsTransmission first = certified();
  std::size_t facets_before = first.facets();
  // number of halvings of the mapping tolerances, which grows each time that no facet is cut
  int halvings = 0;
  return refined(std::move(first), [&](const Quality& quality) -> Refinement<RefractedPathsTransmission> {
    const double room = room_for(most_facets_of_paths, facets_before);
    if (room < least_worth) return {};
    refine(finer.apparent_map, halvings > 0 ? std::exp2(std::min(halvings, 3)) : quality.finer(room),
           transmission.scene().grid.unit_m());
    RefractedPathsTransmission next = certified();
    const bool as_it_was = next.facets() == facets_before;
    halvings = as_it_was ? halvings + 1 : 0;
    facets_before = next.facets();
    return {std::move(next), as_it_was && quality.unbounded > 0};
  });
}

}  // namespace tubefoot
