// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/refraction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "engine/rays/shared_hits.hpp"
#include "run/paths.hpp"
#include "run/simulation.hpp"
#include "run/transmission_rays.hpp"
#include "scene/ping_times.hpp"
#include "scene/scene_water.hpp"
#include "sensors/recordings/sensor_kind.hpp"

// This file maps the facets of a transmission to their apparent positions in refracting water. It chooses
// the tolerances of the map, and counts and reports facets without exactly one eigenray
// (docs/environment.md).

namespace tubefoot {
namespace {

constexpr double degrees = 180 / std::numbers::pi;
constexpr RefinementLimits most_per_transmission{.facets = 20'000'000};

std::array<double, 3> polar(glm::dvec3 direction, double range_m) {
  return {std::atan2(direction.x, direction.y) * degrees,
          std::asin(std::clamp(direction.z, -1.0, 1.0)) * degrees, range_m};
}

/// Returns the result of `make` for a transmission, and converts its exceptions to the terms of the scene
/// file.
template <class Make>
auto made_for(const Transmission& transmission, const Make& make) {
  try {
    return make();
  } catch (...) {
    rethrow_as_seen_by(transmission);
  }
}

/// Returns whether some path involves more than one apparent surface. Each of these surfaces contains first
/// arrivals only.
bool has_paths_of_first_rays(const Survey& survey) {
  return std::ranges::any_of(survey.sensors, [&](const SensorPings& pings) {
    const auto paths = path_settings(survey.scene, pings.sensor->frequency_khz());
    return pings.sensor->has_separate_receiver() || (paths && (paths->order > 1 || paths->scatterings > 1));
  });
}

bool has_receiver_pair(const Survey& survey) {
  return std::ranges::any_of(survey.sensors,
                             [](const SensorPings& pings) { return pings.sensor->has_receiver_pair(); });
}

std::string turning_points(const Survey& survey) {
  const int most = survey.scene.description.water.refraction_turns;
  return fmt::format("at most {} turning point{}", most, most == 1 ? "" : "s");
}

/// Returns a text about the rays that are followed if several rays reach a place. Empty if every ray is
/// followed, in any combination of transmit leg and receive leg.
std::string rays_left_out(const Survey& survey, bool reference) {
  if (reference || has_paths_of_first_rays(survey))
    return "for separate receivers, for paths via mirrors and in references, tubefoot computes only the "
           "first arrival";
  if (has_receiver_pair(survey))
    return "the phases of a receiver pair include each ray in both directions, but not paths whose legs use "
           "different rays";
  return {};
}

/// Returns the travel-path error at which no phase of a receiver pair is wrong by more than phase_error_rad.
/// A position that is displaced by the error turns by error / range as seen from the sonar. The phase
/// changes by 2 pi / wavelength times the baseline times this angle. It changes by 2 pi / wavelength times
/// twice the error if that is less. Infinite without a receiver pair.
double gap_of_phases_m(const Transmission& transmission) {
  // Standard deviation of the phase of a single look at a coherence of 0.9999, which few range bins have.
  constexpr double phase_error_rad = 0.01;
  // Half of a path may exceed the distance from the receiver by up to half of the distance between the two
  // ends.
  const double between_m =
      transmission.has_separate_receiver()
          ? glm::distance(transmission.pose().position_m, transmission.receiver_pose().position_m) / 2
          : 0;
  double travel_path_error_m = std::numeric_limits<double>::infinity();
  for (const std::size_t s : transmission.group().sensors) {
    const Sensor& sensor = transmission.sensor(s);
    if (!sensor.has_receiver_pair()) continue;
    const double wavelength_m = transmission.survey().sensors[s].sound_speed_m_s /
                                (1e3 * sensor.frequency_khz(transmission.number())),
                 baseline_m = sensor.receiver_pair().baseline_m,
                 nearest_m = std::max(transmission.samples(s).first_m - between_m, baseline_m / 2);
    travel_path_error_m = std::min(travel_path_error_m, phase_error_rad * wavelength_m /
                                                            (2 * std::numbers::pi) * nearest_m / baseline_m);
  }
  return std::max(travel_path_error_m, 2 * transmission.scene().grid.unit_m());
}

/// Returns the water of each transmission. Transmissions of equal frequency and absorption share it.
std::vector<std::shared_ptr<const WaterColumn>> columns_of(const SceneWater& water, const Sensor& sensor) {
  std::vector<std::shared_ptr<const WaterColumn>> columns;
  for (std::size_t t = 0; t < sensor.transmissions(); ++t) {
    const double frequency_khz = sensor.frequency_khz(t);
    const std::optional<double> own = sensor.own_absorption_db_per_km(t);
    if (t > 0 && frequency_khz == sensor.frequency_khz(t - 1) &&
        own == sensor.own_absorption_db_per_km(t - 1)) {
      columns.push_back(columns.back());
      continue;
    }
    WaterColumn column = water.column(frequency_khz);
    if (own) std::ranges::fill(column.absorption_db_per_m, *own / 1000);
    columns.push_back(std::make_shared<const WaterColumn>(std::move(column)));
  }
  return columns;
}

nlohmann::ordered_json place_json(const std::array<double, 3>& place) {
  return {{"azimuth_deg", place[0]}, {"elevation_deg", place[1]}, {"range_m", place[2]}};
}

}  // namespace

void rethrow_as_seen_by(const Transmission& transmission) {
  const SourcePlace& place = transmission.scene().description.water.place;
  try {
    throw;
  } catch (const RefinementTooLarge&) {
    throw InputError(place, fmt::format("{} needs more than {} facets at apparent positions: increase "
                                        "'refraction_gap_m' or 'refraction_tolerance_db'",
                                        transmission.name(), most_per_transmission.facets));
  } catch (const GridRangeError&) {
    throw InputError(
        place, fmt::format("{} has apparent positions outside of the grid of the scene: shorten its range",
                           transmission.name()));
  } catch (const std::range_error& error) {
    throw InputError(place,
                     fmt::format("{} has no apparent position: {}, or use smaller facets for the terrain",
                                 transmission.name(), error.what()));
  }
}

PathWater path_water(const Transmission& transmission, std::size_t sensor, double reach_m) {
  const SensorPings& pings = transmission.survey().sensors[sensor];
  return {*pings.water.at(transmission.number()),
          transmission.scene().water->surface_height_m(),
          eigenray_options(transmission.loaded_scene()),
          pings.sound_speed_m_s,
          apparent_map_settings(transmission, reach_m),
          most_per_transmission,
          transmission.scene().grid};
}

EigenrayOptions eigenray_options(const LoadedScene& loaded_scene) {
  EigenrayOptions options;
  options.deepest_turn_m = loaded_scene.scene.water->surface_height_m() - loaded_scene.lowest_m;
  options.most_turns = loaded_scene.scene.description.water.refraction_turns;
  return options;
}

ApparentMap apparent_map_of(const LoadedScene& loaded_scene, const SensorPings& pings,
                            std::size_t transmission, glm::dvec3 apex_m) {
  EigenrayOptions options = eigenray_options(loaded_scene);
  options.frequency_hz = 1e3 * pings.sensor->frequency_khz(transmission);
  return ApparentMap(*pings.water.at(transmission), apex_m, loaded_scene.scene.water->surface_height_m(),
                     options, pings.sound_speed_m_s);
}

double sound_speed_at(const Scene& scene, const SensorDescription& sensor, const Trajectory& trajectory) {
  if (!scene.water->refracts()) return scene.sound_speed_m_s;
  // Only the position is used here, because the samples may still change with the sound speed.
  const auto provisional = make_sensor(in_water(sensor, scene.sound_speed_m_s));
  const double first_s = PingTimes(sensor, trajectory, sensor.trajectory).first_s();
  const glm::dvec3 at_m = provisional->pose_on(trajectory.at(first_s)).position_m;
  return scene.water->profile().at(scene.water->surface_height_m() - at_m.z);
}

void put_into_water(LoadedScene& loaded_scene, SensorSet& sensor_set) {
  const Scene& scene = loaded_scene.scene;
  if (!scene.water->refracts()) return;
  loaded_scene.lowest_m = std::numeric_limits<double>::infinity();
  if (loaded_scene.relief.parent.empty())
    for (const GridPoint& v : scene.mesh.vertices)
      loaded_scene.lowest_m = std::min(loaded_scene.lowest_m, scene.grid.to_metres(v).z);
  else  // heights before relief, so that the result does not depend on how terrain is read
    for (const ComponentReport& component : scene.report.components)
      loaded_scene.lowest_m =
          std::min(loaded_scene.lowest_m, scene.grid.to_metres(scene.grid.snap(component.lo_m)).z);
  for (const TiledTerrain& terrain : scene.tiled)
    if (terrain.tiles)
      loaded_scene.lowest_m =
          std::min(loaded_scene.lowest_m, scene.grid.to_metres(scene.grid.snap(terrain.tiles->lo_m())).z);
  for (const MovingObject& object : scene.moving)
    loaded_scene.lowest_m = std::min(loaded_scene.lowest_m, object.lowest_m);
  if (loaded_scene.relief.omitted) loaded_scene.lowest_m -= loaded_scene.relief.omitted->largest_height_m();
  const double surface = scene.water->surface_height_m();
  for (SensorPings& pings : sensor_set.sensors) {
    pings.water = columns_of(*scene.water, *pings.sensor);
    const auto check = [&](const Pose& pose) {
      if (!(pose.position_m.z <= surface))
        throw InputError(pings.sensor->description().place,
                         fmt::format("sensor '{}' is {:.3g} m above the sea surface (at {:.6g} m): lower "
                                     "its trajectory, or raise 'surface_height_m' of [water]",
                                     pings.sensor->description().name, pose.position_m.z - surface, surface));
    };
    std::ranges::for_each(pings.poses, check);
    std::ranges::for_each(pings.transmission_poses, check);
    std::ranges::for_each(pings.receiver_poses, check);
  }
}

ApparentMapSettings apparent_map_settings(const Transmission& transmission, double reach_m) {
  const WaterDescription& keys = transmission.scene().description.water;
  const double sample = transmission.sample_length_m();
  ApparentMapSettings settings;
  settings.travel_path_error_m =
      keys.travel_path_error_m.value_or(std::min(sample / 4, gap_of_phases_m(transmission)));
  settings.tolerance_db = keys.refraction_tolerance_db.value_or(0.1);
  // Caustics and shadow boundaries thus cause only as many edges of this length as fit across a sector.
  settings.shortest_edge_m = std::max({sample, reach_m / 2000, 16 * transmission.scene().grid.unit_m()});
  settings.shadow_edge_m = std::max(4 * settings.shortest_edge_m, reach_m / 50);
  // A travel-path error that the user sets, or that phases require, is observed where rays do not cross. For
  // an edge of length e it is at most (g / c) e^2 / 4, for the gradient g of the sound speed c.
  const double bend_per_m = transmission.scene().water->profile().largest_bend_per_m();
  if ((keys.travel_path_error_m || settings.travel_path_error_m < sample / 4) && bend_per_m > 0)
    settings.shortest_edge_m =
        std::min(settings.shortest_edge_m, std::max(std::sqrt(settings.travel_path_error_m / bend_per_m),
                                                    16 * transmission.scene().grid.unit_m()));
  return settings;
}

TrueSurface::TrueSurface(const Transmission& transmission, std::span<const TubeSet> tubes,
                         std::span<const ViewBounds> all_view_bounds, bool weights)
    : loaded_scene_(transmission.loaded_scene()) {
  if (!loaded_scene_.surface_mesh) {
    if (loaded_scene_.moving) surface_.emplace(moved_surface_of(transmission, weights));
    return;
  }
  std::vector<Look> looks = transmission.looks(tubes);
  for (std::size_t k = 0; k < looks.size(); ++k) looks[k].view_bounds = &all_view_bounds[k];
  surface_.emplace(loaded_scene_, relief_seen_by(transmission, looks, weights));
}

const FacetMesh& TrueSurface::mesh() const { return surface_ ? surface_->mesh() : loaded_scene_.scene.mesh; }

std::vector<FacetId> TrueSurface::facets(std::span<const ViewBounds> all_view_bounds) const {
  std::vector<FacetId> all;
  for (const ViewBounds& view_bounds : all_view_bounds) {
    const std::vector<FacetId> some = view_bounds.facets(
        mesh(), surface_ ? surface_->tree() : *loaded_scene_.tree, loaded_scene_.scene.grid);
    all.insert(all.end(), some.begin(), some.end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

void TrueSurface::name_by_scene(ApparentSurface& surface_mesh) const {
  if (!surface_ || !surface_->is_own()) return;
  const RefinedMesh& relief = *surface_->refined();
  for (std::size_t k = 0; k < surface_mesh.refined.parent.size(); ++k) {
    FacetId& facet = surface_mesh.refined.parent[k];
    if (!surface_mesh.refined.weights.empty())
      surface_mesh.refined.weights[k] = part_of_part(relief.weights[facet], surface_mesh.refined.weights[k]);
    facet = relief.parent[facet];
  }
  for (UnclearPlace& place : surface_mesh.unclear) place.facet = relief.parent[place.facet];
}

TransmissionApparentMap::TransmissionApparentMap(const Transmission& transmission, bool weights)
    : transmission_(transmission),
      weights_(weights),
      tubes_(transmission.tubes()),
      apparent_map_(apparent_map_of(transmission.loaded_scene(), transmission.pings(), transmission.number(),
                                    transmission.scene().grid.to_metres(tubes_.apex))),
      view_bounds_(tubes_, transmission.scene().grid.unit_m(), apparent_map_),
      seabed_(transmission, {&tubes_, 1}, {&view_bounds_, 1}, weights),
      facets_(seabed_.facets({&view_bounds_, 1})) {}

ApparentSurface TransmissionApparentMap::surface_mesh(const ApparentMapSettings& settings) const {
  const Scene& scene = transmission_.scene();
  return made_for(transmission_, [&] {
    return map_apparent(seabed_.mesh(), facets_, scene.grid, apparent_map_,
                        absorption_db_per_m(scene, *transmission_.pings().sensor, transmission_.number()),
                        settings, {most_per_transmission.facets, weights_}, scene.scattering, &view_bounds_);
  });
}

TransmissionSurface refracted_surface_of(const Transmission& transmission, bool weights) {
  const TransmissionApparentMap seen(transmission, weights);
  ApparentMapSettings settings =
      apparent_map_settings(transmission, transmission.tubes().reach * transmission.scene().grid.unit_m());
  settings.later_arrivals = true;
  ApparentSurface surface_mesh = seen.surface_mesh(settings);
  seen.seabed().name_by_scene(surface_mesh);
  return TransmissionSurface(transmission.loaded_scene(), std::move(surface_mesh));
}

EndsApparentMap::EndsApparentMap(const Transmission& transmission, std::vector<TubeSet> tubes,
                                 std::vector<ApparentMap> water, bool weights)
    : transmission_(transmission), weights_(weights), tubes_(std::move(tubes)), water_(std::move(water)) {
  for (std::size_t end = 0; end < tubes_.size(); ++end)
    all_view_bounds_.emplace_back(tubes_[end], transmission.scene().grid.unit_m(), water_[end]);
  seabed_.emplace(transmission, tubes_, all_view_bounds_, weights);
  // Contains all facets that any end may see. A facet hidden from one end need not be seen by another.
  facets_ = seabed_->facets(all_view_bounds_);
}

double EndsApparentMap::absorption_db_per_m() const {
  return tubefoot::absorption_db_per_m(transmission_.scene(), *transmission_.pings().sensor,
                                       transmission_.number());
}

double EndsApparentMap::reach_m() const {
  return std::ranges::max_element(tubes_, {}, &TubeSet::reach)->reach * transmission_.scene().grid.unit_m();
}

CommonApparentSurfaces EndsApparentMap::surface_meshes(const ApparentMapSettings& settings) const {
  std::vector<const ApparentMap*> ways;
  std::vector<const ViewBounds*> all_view_bounds;
  for (std::size_t end = 0; end < tubes_.size(); ++end) {
    ways.push_back(&water_[end]);
    all_view_bounds.push_back(&all_view_bounds_[end]);
  }
  return made_for(transmission_, [&] {
    return map_apparent_together(seabed_->mesh(), facets_, transmission_.scene().grid, ways,
                                 absorption_db_per_m(), settings, {most_per_transmission.facets, weights_},
                                 all_view_bounds);
  });
}

namespace {

std::vector<ApparentMap> water_of_both(const Transmission& transmission) {
  const WorldGrid& grid = transmission.scene().grid;
  return {apparent_map_of(transmission.loaded_scene(), transmission.pings(), transmission.number(),
                          grid.to_metres(transmission.tubes().apex)),
          apparent_map_of(transmission.loaded_scene(), transmission.pings(), transmission.number(),
                          grid.to_metres(transmission.receive_tubes(transmission.first()).apex))};
}

}  // namespace

PairApparentMap::PairApparentMap(const Transmission& transmission, bool weights)
    : ends_(transmission, {transmission.tubes(), transmission.receive_tubes(transmission.first())},
            water_of_both(transmission), weights) {}

RefractedPair PairApparentMap::pair(const ApparentMapSettings& settings) const {
  CommonApparentSurfaces surface_meshes = ends_.surface_meshes(settings);
  return {ends_.tubes(0),
          ends_.tubes(1),
          ends_.water(0),
          ends_.water(1),
          ends_.absorption_db_per_m(),
          {std::move(surface_meshes.seabed.mesh), std::move(surface_meshes.seen[0]),
           std::move(surface_meshes.seen[1]), std::move(surface_meshes.origin[0]),
           std::move(surface_meshes.origin[1])}};
}

RefractedPair refracted_pair_of(const Transmission& transmission, bool weights) {
  const PairApparentMap both(transmission, weights);
  RefractedPair pair = both.pair(apparent_map_settings(transmission, both.reach_m()));
  both.seabed().name_by_scene(pair.apparent.transmit);
  both.seabed().name_by_scene(pair.apparent.receive);
  return pair;
}

BistaticHistory trace_both(const Transmission& transmission, const RefractedPair& pair) {
  return made_for(transmission, [&] {
    return trace_bistatic(pair.apparent, transmission.scene().grid, transmission.request().visibility,
                          pair.transmit_tubes, pair.receive_tubes, pair.transmit_water, pair.receive_water,
                          pair.absorption_db_per_m);
  });
}

std::vector<ReceiverBaseline> refracted_receiver_baselines(const Transmission& transmission,
                                                           const RefractedPair& pair) {
  // Phases depend on the sound speed at the receivers, but ranges are computed with another sound speed.
  const Scene& scene = transmission.scene();
  const double stretch =
      pair.transmit_water.reference_speed_m_s() /
      scene.water->profile().at(scene.water->surface_height_m() - pair.receive_water.apex_m().z);
  std::vector<ReceiverBaseline> baselines =
      transmission.pings()
          .sensor
          ->patterns(transmission.receiver_pose(), transmission.pings().sound_speed_m_s,
                     transmission.number())
          .baselines;
  for (ReceiverBaseline& baseline : baselines) baseline.baseline_m *= stretch;
  return baselines;
}

ReceiverPairHistory trace_receiver_pair(const Transmission& transmission, const RefractedPair& pair,
                                        std::uint32_t fan, const ReceiverBaseline& receiver_pair) {
  const std::vector<std::uint32_t> fans = transmission.pings().sensor->fan_of_tube(transmission.number());
  return made_for(transmission, [&] {
    return trace_receiver_pair(pair.apparent, transmission.scene().grid, transmission.request().visibility,
                               tubes_of_fan(pair.transmit_tubes, fans, fan),
                               tubes_of_fan(pair.receive_tubes, fans, fan), receiver_pair,
                               pair.transmit_water, pair.receive_water, pair.absorption_db_per_m);
  });
}

void trace_rays_of_both(const Transmission& transmission, const RefractedPair& pair,
                        const RaySettings& settings,
                        const std::function<void(const BistaticHistory&)>& take) {
  const WorldGrid& grid = transmission.scene().grid;
  const ApparentPair& seen = pair.apparent;
  const RayScene sent_to(seen.transmit.refined.mesh, grid), received_from(seen.receive.refined.mesh, grid);
  const TubeFinder sent_tubes(pair.transmit_tubes), received_tubes(pair.receive_tubes);
  const SampledEnd sent{sent_to, pair.transmit_tubes, sent_tubes, seen.transmit_origin},
      received{received_from, pair.receive_tubes, received_tubes, seen.receive_origin};
  ApparentFacets there;
  there.received.assign(seen.mesh.facets.size(), ApparentFacets::none);
  for (FacetId facet = 0; facet < seen.receive_origin.size(); ++facet)
    there.received[seen.receive_origin[facet]] = facet;
  History history;
  history.tubes = pair.transmit_tubes;
  history.grid_unit_m = grid.unit_m();
  const RayGuide guide = guide_of(transmission);
  const auto take_shared = [&] {
    BistaticHistory both = shared_hits(history, sent, received, seen.mesh, &there);
    both.bistatic = made_for(transmission, [&] {
      return bistatic_facets(both.shared, seen, grid, pair.transmit_water, pair.receive_water,
                             pair.absorption_db_per_m);
    });
    take(both);
  };
  trace_rays(sent_to, history, settings,
             transmission.sensor(transmission.first()).beam_of_tube(transmission.number()), take_shared,
             nullptr, &guide);
}

void add_counts(ApparentMapCounts& counts, const ApparentSurface& surface_mesh,
                const Transmission& transmission) {
  add_counts(counts,
             SurfaceCounts{surface_mesh.refined.mesh.facets.size(), surface_mesh.facets_in_shadow,
                           surface_mesh.facets_of_several, surface_mesh.facets_folded,
                           surface_mesh.largest_travel_path_error_m, surface_mesh.unclear},
             transmission);
}

void add_counts(ApparentMapCounts& counts, const SurfaceCounts& surface_meshes,
                const Transmission& transmission) {
  ApparentMapCounts own{surface_meshes.facets, surface_meshes.in_shadow, surface_meshes.of_several,
                        surface_meshes.folded, surface_meshes.largest_travel_path_error_m};
  const glm::dvec3 apex = transmission.pose().position_m;
  const auto keep = [&](const UnclearPlace& place, std::array<double, 3>& kept) {
    if (kept[2] == 0) kept = polar(place.direction, glm::distance(place.at_m, apex));
  };
  for (const UnclearPlace& place : surface_meshes.unclear)
    keep(place, place.eigenrays == 0 ? own.shadow : own.several);
  add_counts(counts, own);
}

void add_counts(ApparentMapCounts& sum, const ApparentMapCounts& more) {
  sum.facets += more.facets;
  if (sum.in_shadow == 0) sum.shadow = more.shadow;
  if (sum.of_several == 0) sum.several = more.several;
  sum.in_shadow += more.in_shadow;
  sum.of_several += more.of_several;
  sum.folded += more.folded;
  sum.unbounded += more.unbounded;
  sum.at_limit += more.at_limit;
  sum.largest_travel_path_error_m =
      std::max(sum.largest_travel_path_error_m, more.largest_travel_path_error_m);
}

nlohmann::ordered_json refraction_json(const Survey& survey, bool reference, const SimulationStats& stats) {
  const ApparentMapCounts& counts = stats.refraction;
  const std::string left_out = rays_left_out(survey, reference);
  nlohmann::ordered_json json{
      {"profile", survey.scene.description.water.profile},
      {"layers", survey.scene.water->profile().layers()},
      {"branches",
       fmt::format(
           "{}, with {}",
           left_out.empty() ? "every ray, in any combination of transmit leg and receive leg" : left_out,
           turning_points(survey))},
      {"apparent_facets", counts.facets},
      {"largest_gap_m", counts.largest_travel_path_error_m},
      {"facets_in_shadow", counts.in_shadow},
      {"facets_of_several_rays", counts.of_several},
      {"facets_folded", counts.folded}};
  for (const SensorPings& pings : survey.sensors)
    json["sound_speed_m_s"][pings.sensor->description().name] = pings.sound_speed_m_s;
  if (counts.in_shadow > 0) {
    json["pings_with_shadows"] = stats.shadowed_pings;
    json["first_shadow"] = place_json(counts.shadow);
  }
  if (counts.unbounded > 0) json["bins_without_bound"] = counts.unbounded;
  if (counts.at_limit > 0) json["transmissions_at_work_limit"] = counts.at_limit;
  if (counts.of_several > 0) json["first_of_several"] = place_json(counts.several);
  return json;
}

std::vector<std::string> refraction_warnings(const Survey& survey, bool reference,
                                             const SimulationStats& stats) {
  const ApparentMapCounts& counts = stats.refraction;
  std::vector<std::string> warnings;
  const auto at = [](const std::array<double, 3>& place) {
    return fmt::format("the first at azimuth {:.1f} and elevation {:.1f} degrees, {:.4g} m away", place[0],
                       place[1], place[2]);
  };
  const std::string where = to_string(survey.scene.description.water.place);
  if (counts.in_shadow > 0)
    warnings.push_back(
        fmt::format("{}: {} apparent facets of {} pings are omitted, because no ray leads to them or to a "
                    "part of them (a shadow zone); {}",
                    where, counts.in_shadow, stats.shadowed_pings, at(counts.shadow)));
  const std::string left_out = rays_left_out(survey, reference);
  if (counts.of_several > 0 && !left_out.empty())
    warnings.push_back(fmt::format("{}: several rays, with {}, lead to {} facets: {}; {}", where,
                                   turning_points(survey), counts.of_several, left_out, at(counts.several)));
  if (counts.folded > 0 && has_paths_of_first_rays(survey))
    warnings.push_back(
        fmt::format("{}: {} apparent facets are inverted, because rays cross in front of them (a caustic); "
                    "energies there are unreliable",
                    where, counts.folded));
  if (counts.unbounded > 0)
    warnings.push_back(fmt::format(
        "{}: {} bins have no bound (energy_bound is infinite): they can contain echoes of facets for which "
        "tubefoot cannot prove that exactly one ray leads to them, or echoes that such facets hide",
        where, counts.unbounded));
  const std::optional<double> requested_m = survey.scene.description.water.travel_path_error_m;
  if (requested_m && counts.largest_travel_path_error_m > *requested_m)
    warnings.push_back(fmt::format(
        "{}: 'refraction_gap_m' is {:.3g} m, but the travel-path error reaches {:.3g} m: tubefoot does not "
        "divide edges that are near a caustic or a shadow zone, or as short as the grid allows",
        where, *requested_m, counts.largest_travel_path_error_m));
  if (counts.at_limit > 0)
    warnings.push_back(
        fmt::format("{}: the bounds of {} transmissions are valid but wider than requested, because narrower "
                    "bounds would need too many apparent facets: increase --tolerance",
                    where, counts.at_limit));
  return warnings;
}

}  // namespace tubefoot
