// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/path_parts.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "engine/paths/path_echo.hpp"
#include "engine/paths/receiver_pair_paths.hpp"
#include "run/label_parts.hpp"
#include "run/paths.hpp"
#include "run/receiver_pair_rows.hpp"
#include "run/refracted_reference.hpp"
#include "run/refraction.hpp"
#include "run/transmission_images.hpp"
#include "run/transmission_rays.hpp"

// This file adds the echoes of paths over mirrors and of second scatterings to a ping, by order, for single
// receivers and receiver pairs (docs/environment.md).

namespace tubefoot {
namespace {

/// The seabed of a sensor's paths at its true position. In refracting water, images make apparent surfaces
/// of their own.
class PathSeabed {
 public:
  PathSeabed(const Transmission& transmission, std::size_t s, const PathEnds& ends)
      : transmission_(transmission) {
    const bool refracts = transmission.scene().water->refracts();
    if (refracts || has_path_surface(transmission.scene())) lying_.emplace(path_surface_of(transmission));
    if (!refracts) return;
    water_.emplace(path_water(transmission, s, ends.transmit.reach * transmission.scene().grid.unit_m()));
  }
  const TransmissionSurface& operator*() const { return lying_ ? *lying_ : transmission_.surface_mesh(); }
  /// Returns null in isovelocity water.
  const PathWater* water() const { return water_ ? &*water_ : nullptr; }

 private:
  const Transmission& transmission_;
  std::optional<TransmissionSurface> lying_;
  std::optional<PathWater> water_;
};

template <class Work>
auto as_seen_by(const Transmission& transmission, const Work& work) {
  try {
    return work();
  } catch (const RefinementTooLarge&) {
    rethrow_as_seen_by(transmission);
  } catch (const std::range_error&) {
    rethrow_as_seen_by(transmission);
  }
}

void count_paths(const Transmission& transmission, const auto& paths, PingSums& sums) {
  ApparentMapCounts& counts = sums.counts.refraction;
  add_counts(counts, paths.seen_by_patches, transmission);
  for (const ApparentSurface& apparent : paths.surface_meshes) add_counts(counts, apparent, transmission);
  counts.largest_travel_path_error_m = std::max(counts.largest_travel_path_error_m, paths.largest_misfit_m);
  sums.counts.images += paths.images;
  sums.counts.arrivals += paths.arrivals;
  sums.counts.pieces += paths.shared_pieces;
}

void add_paths_of(const Transmission& transmission, std::size_t s, const PathSettings& requested,
                  PingSums& sums) {
  const Sensor& sensor = transmission.sensor(s);
  PathSettings settings = requested;
  settings.binning = transmission.request().binning;
  const PathEnds ends(transmission, s);
  const std::vector<std::uint32_t> fans = sensor.fan_of_tube(transmission.number());
  const PathSeabed seabed(transmission, s, ends);
  const SensorModel model(transmission, *seabed, s);
  std::optional<RaySurface> rays;
  if (transmission.request().engine == Engine::ray)
    settings.sampled =
        SampledPaths{seabed.water() != nullptr ? nullptr : &*rays.emplace(transmission, *seabed),
                     transmission.scene().grid, rays_of(transmission),
                     sensor.beam_of_tube(transmission.number()), guide_of(transmission)};
  const auto trace_by = [&](const FacetMesh& mesh, const EchoModel& by, const PathSettings& how,
                            const PathWater* water) {
    return path_echo(mesh, (*seabed).tree(), transmission.scene().grid.unit_m(),
                     transmission.request().visibility, ends.transmit, ends.receive,
                     transmission.beams_by_fans(s, fans), transmission.samples(s), by, how, water);
  };
  const auto trace = [&](const PathWater* water) {
    return trace_by((*seabed).mesh(), model.model, settings, water);
  };
  const bool own_surfaces = settings.reference_tolerance && seabed.water() != nullptr;
  RefractedPathsTransmission found = as_seen_by(transmission, [&] {
    if (!own_surfaces) return RefractedPathsTransmission{trace(seabed.water()), {}, false};
    return certify_refracted_paths(transmission, *seabed.water(),
                                   ends.transmit.reach * transmission.scene().grid.unit_m(),
                                   [&](const PathWater& water) { return trace(&water); });
  });
  const PathEcho& paths = found.paths;
  sums.counts.refraction.at_limit += found.at_limit;
  for (std::size_t order = 0; order < paths.by_order.size(); ++order) {
    if (!is_order_wanted(transmission.scene(), order)) continue;
    if (own_surfaces) {
      sums.add(transmission, s, found.orders[order].certified, order);
      continue;
    }
    if (!settings.reference_tolerance) {
      sums.add(transmission, s, order, paths.by_order[order].energy);
      continue;
    }
    CertifiedEcho certified{paths.by_order[order], paths.bound_by_order[order]};
    compare_with(certified, *settings.reference_tolerance);
    sums.add(transmission, s, certified, order);
  }
  sums.counts.hits += paths.hits;
  count_paths(transmission, paths, sums);
  add_labels_of_paths(transmission, s, (*seabed).mesh(), model.model, settings, sums,
                      [&](const FacetMesh& mesh, const EchoModel& by, const PathSettings& how) {
                        return wanted_orders(transmission, as_seen_by(transmission, [&] {
                                               return trace_by(mesh, by, how, seabed.water());
                                             }));
                      });
}

void add_receiver_pair_paths_of(const Transmission& transmission, std::size_t s, const PathSettings& settings,
                                PingSums& sums) {
  const Sensor& sensor = transmission.sensor(s);
  const PathEnds ends(transmission, s);
  const std::vector<std::uint32_t> fans = sensor.fan_of_tube(transmission.number());
  const PathSeabed seabed(transmission, s, ends);
  const SensorModel model(transmission, *seabed, s);
  std::vector<ReceiverPairRows> by_order(std::size_t(settings.order) + 1, ReceiverPairRows(transmission, s));
  for (std::uint32_t fan = 0; fan < model.patterns.baselines.size(); ++fan) {
    const TubeSet transmit = tubes_of_fan(ends.transmit, fans, fan),
                  receive = tubes_of_fan(ends.receive, fans, fan);
    const BeamPatterns patterns = patterns_of_fan(model.patterns, fan, receive.tubes.size());
    EchoModel own = model.model;
    own.patterns = &patterns;
    const auto trace = [&](const FacetMesh& mesh, const EchoModel& by, const PathSettings& how) {
      return as_seen_by(transmission, [&] {
        return receiver_pair_path_echo(mesh, (*seabed).tree(), transmission.scene().grid.unit_m(),
                                       transmission.request().visibility,
                                       {transmit, receive, model.patterns.baselines[fan]},
                                       transmission.samples(s), by, how, seabed.water());
      });
    };
    const ReceiverPairPathEcho paths = trace((*seabed).mesh(), own, settings);
    for (std::size_t order = 0; order < paths.by_order.size(); ++order) {
      if (!settings.reference_tolerance) {
        by_order[order].set(fan, paths.by_order[order]);
        continue;
      }
      CertifiedEcho certified{rows_of(paths.by_order[order]), rows_of(paths.bound_by_order[order]).energy};
      compare_receiver_pair_with(certified, *settings.reference_tolerance);
      by_order[order].set(fan, certified);
    }
    count_paths(transmission, paths, sums);
    add_labels_of_paths(transmission, s, (*seabed).mesh(), own, settings, sums,
                        [&](const FacetMesh& mesh, const EchoModel& by, const PathSettings& how) {
                          return row_of_fan(transmission, s, fan,
                                            wanted_orders(transmission, trace(mesh, by, how)));
                        });
  }
  for (std::size_t order = 0; order < by_order.size(); ++order)
    if (is_order_wanted(transmission.scene(), order)) by_order[order].add_to(sums, transmission, s, order);
}

void add_for_sensors(const EchoContribution& plan, const Transmission& transmission, PingSums& sums,
                     decltype(add_paths_of)& add) {
  for (const std::size_t s : plan.sensors) try {
      PathSettings settings = *path_settings(transmission, s);
      settings.reference_tolerance = plan.tolerance;
      settings.rounds_corners = transmission.request().rounds_corners;
      add(transmission, s, settings, sums);
    } catch (const std::length_error& error) {
      throw too_many_images(transmission.sensor(s).description(), error);
    }
}

}  // namespace

void add_paths(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  add_for_sensors(plan, transmission, sums, add_paths_of);
}

void add_receiver_pair_paths(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  add_for_sensors(plan, transmission, sums, add_receiver_pair_paths_of);
}

}  // namespace tubefoot
