// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/refraction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "run/simulation.hpp"
#include "scene/scene_water.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

constexpr double degrees = 180 / std::numbers::pi;
constexpr RefinementLimits most_a_shot{.facets = 20'000'000};

std::array<double, 3> polar(glm::dvec3 direction, double range_m) {
  return {std::atan2(direction.x, direction.y) * degrees,
          std::asin(std::clamp(direction.z, -1.0, 1.0)) * degrees, range_m};
}

/// What `make` makes for a shot; what it throws, with the scene file's words.
template <class Make>
auto made_for(const Shot& shot, const Make& make) {
  const SourcePlace& place = shot.scene().description.water.place;
  try {
    return make();
  } catch (const RefinementTooLarge&) {
    throw InputError(place, fmt::format("{} needs more than {} facets to be seen through the water: raise "
                                        "'refraction_gap_m' or 'refraction_tolerance_db'",
                                        shot.name(), most_a_shot.facets));
  } catch (const GridRangeError&) {
    throw InputError(place, fmt::format("{} sees facets through the water outside of the scene's grid: "
                                        "shorten its range",
                                        shot.name()));
  } catch (const std::range_error& error) {
    throw InputError(place, fmt::format("{} cannot be seen through the water: {}, or give the terrain "
                                        "smaller facets",
                                        shot.name(), error.what()));
  }
}

/// The bed of a shot where it lies: the scene's, or with relief as fine as bent rays need it.
class LyingBed {
 public:
  /// `outlooks`: of each set of tubes.
  LyingBed(const Shot& shot, std::span<const TubeSet> tubes, std::span<const Outlook> outlooks, bool weights)
      : site_(shot.site()) {
    if (!site_.ground) return;
    std::vector<Look> looks = shot.looks(tubes);
    for (std::size_t k = 0; k < looks.size(); ++k) looks[k].outlook = &outlooks[k];
    relief_ = relief_seen_by(shot, looks, weights);
    tree_ = std::make_unique<SceneTree>(relief_.mesh, SceneTree::Sheets::ignored);
  }
  const FacetMesh& mesh() const { return tree_ ? relief_.mesh : site_.scene.mesh; }
  /// Of any of the outlooks, by increasing id.
  std::vector<FacetId> facets(std::span<const Outlook> outlooks) const {
    std::vector<FacetId> all;
    for (const Outlook& outlook : outlooks) {
      const std::vector<FacetId> some =
          outlook.facets(mesh(), tree_ ? *tree_ : *site_.tree, site_.scene.grid);
      all.insert(all.end(), some.begin(), some.end());
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }
  /// From facets of this bed to the scene's.
  void name_by_scene(ApparentGround& ground) const {
    if (!tree_) return;
    for (std::size_t k = 0; k < ground.refined.parent.size(); ++k) {
      FacetId& facet = ground.refined.parent[k];
      if (!ground.refined.weights.empty())
        ground.refined.weights[k] = part_of_part(relief_.weights[facet], ground.refined.weights[k]);
      facet = relief_.parent[facet];
    }
    for (UnclearPlace& place : ground.unclear) place.facet = relief_.parent[place.facet];
  }

 private:
  const Site& site_;
  RefinedMesh relief_;
  std::unique_ptr<SceneTree> tree_;  // of the relief
};

nlohmann::ordered_json place_json(const std::array<double, 3>& place) {
  return {{"azimuth_deg", place[0]}, {"elevation_deg", place[1]}, {"range_m", place[2]}};
}

}  // namespace

EigenrayOptions eigenray_options(const Site& site) {
  EigenrayOptions options;
  options.deepest_turn_m = site.scene.water->surface_height_m() - site.lowest_m;
  return options;
}

Straightening straightening_of(const Site& site, const SensorPings& pings, glm::dvec3 apex_m) {
  return Straightening(*pings.water, apex_m, site.scene.water->surface_height_m(), eigenray_options(site),
                       pings.sound_speed_m_s);
}

double sound_speed_at(const Scene& scene, const SensorDescription& sensor, const Trajectory& trajectory) {
  if (!scene.water->refracts()) return scene.sound_speed_m_s;
  // Only a place is asked of it: the samples may still change with the speed.
  const auto provisional = make_sensor(in_water(sensor, scene.sound_speed_m_s));
  const std::vector<double> times_s = provisional->ping_times_s();
  const glm::dvec3 at_m = provisional->pose_on(trajectory.at(times_s.front())).position_m;
  return scene.water->profile().at(scene.water->surface_height_m() - at_m.z);
}

void put_into_water(Site& site, Fleet& fleet) {
  const Scene& scene = site.scene;
  if (!scene.water->refracts()) return;
  site.lowest_m = std::numeric_limits<double>::infinity();
  for (const GridPoint& v : scene.mesh.vertices)
    site.lowest_m = std::min(site.lowest_m, scene.grid.to_metres(v).z);
  for (const TiledTerrain& terrain : scene.tiled)
    if (terrain.tiles)
      site.lowest_m = std::min(site.lowest_m, scene.grid.to_metres(scene.grid.snap(terrain.tiles->lo_m())).z);
  if (site.ground) site.lowest_m -= site.ground->omitted().largest_height_m();
  const double surface = scene.water->surface_height_m();
  for (SensorPings& pings : fleet.sensors) {
    pings.water = std::make_shared<const WaterColumn>(scene.water->column(pings.sensor->frequency_khz()));
    for (const auto* poses : {&pings.poses, &pings.shot_poses, &pings.receiver_poses})
      for (const Pose& pose : *poses)
        if (!(pose.position_m.z <= surface))
          throw InputError(
              pings.sensor->description().place,
              fmt::format("sensor '{}' is {:.3g} m above the sea surface (at {:.6g} m): lower "
                          "its trajectory, or raise 'surface_height_m' of [water]",
                          pings.sensor->description().name, pose.position_m.z - surface, surface));
  }
}

StraighteningSettings straightening_settings(const Shot& shot, double reach_m) {
  const WaterDescription& keys = shot.scene().description.water;
  const double sample = shot.sample_length_m();
  StraighteningSettings settings;
  settings.gap_m = keys.refraction_gap_m.value_or(sample / 4);
  settings.tolerance_db = keys.refraction_tolerance_db.value_or(0.1);
  // Caustics and the borders of shadows take no more edges than a sector is wide.
  settings.shortest_edge_m = std::max({sample, reach_m / 2000, 16 * shot.scene().grid.unit_m()});
  settings.shadow_edge_m = std::max(4 * settings.shortest_edge_m, reach_m / 50);
  // A gap that is asked for is kept where rays do not cross: of an edge it is no more than g / c a quarter of
  // its square.
  const double bend_per_m = shot.scene().water->profile().largest_bend_per_m();
  if (keys.refraction_gap_m && bend_per_m > 0)
    settings.shortest_edge_m =
        std::min(settings.shortest_edge_m,
                 std::max(std::sqrt(settings.gap_m / bend_per_m), 16 * shot.scene().grid.unit_m()));
  return settings;
}

ShotGround refracted_ground_of(const Shot& shot, bool weights) {
  return refracted_ground_of(
      shot, straightening_settings(shot, shot.tubes().reach * shot.scene().grid.unit_m()), weights);
}

ShotGround refracted_ground_of(const Shot& shot, const StraighteningSettings& settings, bool weights) {
  const Scene& scene = shot.scene();
  const TubeSet tubes = shot.tubes();
  const Straightening straightening =
      straightening_of(shot.site(), shot.pings(), scene.grid.to_metres(tubes.apex));
  const Outlook outlook(tubes, scene.grid.unit_m(), straightening);
  const LyingBed bed(shot, {&tubes, 1}, {&outlook, 1}, weights);
  const std::vector<FacetId> facets = bed.facets({&outlook, 1});
  return made_for(shot, [&] {
    ApparentGround ground = straighten(bed.mesh(), facets, scene.grid, straightening,
                                       absorption_db_per_m(scene, *shot.pings().sensor), settings,
                                       {most_a_shot.facets, weights}, scene.scattering, &outlook);
    bed.name_by_scene(ground);
    return ShotGround(shot.site(), std::move(ground));
  });
}

RefractedPair refracted_pair_of(const Shot& shot, bool weights) {
  const Scene& scene = shot.scene();
  const double unit = scene.grid.unit_m(), absorption = absorption_db_per_m(scene, *shot.pings().sensor);
  std::array<TubeSet, 2> tubes{shot.tubes(), shot.receive_tubes(shot.first())};
  const auto water_from = [&](const TubeSet& set) {
    return straightening_of(shot.site(), shot.pings(), scene.grid.to_metres(set.apex));
  };
  std::array<Straightening, 2> water{water_from(tubes[0]), water_from(tubes[1])};
  const std::array<Outlook, 2> outlooks{Outlook(tubes[0], unit, water[0]), Outlook(tubes[1], unit, water[1])};
  const LyingBed bed(shot, tubes, outlooks, weights);
  // What either may see: what hides from one need not be seen by the other.
  const std::vector<FacetId> facets = bed.facets(outlooks);
  return made_for(shot, [&] {
    const double reach_m = std::max(tubes[0].reach, tubes[1].reach) * unit;
    ApparentPair pair = straighten_pair(bed.mesh(), facets, scene.grid, water[0], water[1], absorption,
                                        straightening_settings(shot, reach_m), {most_a_shot.facets, weights},
                                        &outlooks[0], &outlooks[1]);
    bed.name_by_scene(pair.transmit);
    bed.name_by_scene(pair.receive);
    std::vector<FacetId> parent(pair.mesh.facets.size());
    for (std::size_t k = 0; k < pair.transmit_origin.size(); ++k)
      parent[pair.transmit_origin[k]] = pair.transmit.refined.parent[k];
    return RefractedPair{std::move(pair), std::move(parent), std::move(tubes), std::move(water), absorption};
  });
}

BistaticHistory RefractedPair::trace(const Shot& shot) const {
  return trace_bistatic(pair, shot.scene().grid, shot.request().visibility, tubes[0], tubes[1], water[0],
                        water[1], absorption_db_per_m);
}

RefractedPaths refracted_paths_of(const Shot& shot) {
  RefractedPair seen = refracted_pair_of(shot);
  BistaticHistory history = seen.trace(shot);
  return {std::move(seen.pair), std::move(history)};
}

void add_counts(StraighteningCounts& counts, const ApparentGround& ground, const Shot& shot) {
  StraighteningCounts own;
  own.facets = ground.refined.mesh.facets.size();
  own.in_shadow = ground.facets_in_shadow;
  own.of_several = ground.facets_of_several;
  own.folded = ground.facets_folded;
  own.largest_gap_m = ground.largest_gap_m;
  const glm::dvec3 apex = shot.pose().position_m;
  const auto keep = [&](const UnclearPlace& place, std::array<double, 3>& kept) {
    if (kept[2] == 0) kept = polar(place.direction, glm::distance(place.at_m, apex));
  };
  for (const UnclearPlace& place : ground.unclear)
    keep(place, place.eigenrays == 0 ? own.shadow : own.several);
  add_counts(counts, own);
}

void add_counts(StraighteningCounts& sum, const StraighteningCounts& more) {
  sum.facets += more.facets;
  if (sum.in_shadow == 0) sum.shadow = more.shadow;
  if (sum.of_several == 0) sum.several = more.several;
  sum.in_shadow += more.in_shadow;
  sum.of_several += more.of_several;
  sum.folded += more.folded;
  sum.unbounded += more.unbounded;
  sum.at_limit += more.at_limit;
  sum.largest_gap_m = std::max(sum.largest_gap_m, more.largest_gap_m);
}

nlohmann::ordered_json refraction_json(const Survey& survey, const SimulationStats& stats) {
  const StraighteningCounts& counts = stats.refraction;
  nlohmann::ordered_json json{{"profile", survey.scene.description.water.profile},
                              {"layers", survey.scene.water->profile().layers()},
                              {"branches", "the first ray to arrive, with one turning point at most"},
                              {"apparent_facets", counts.facets},
                              {"largest_gap_m", counts.largest_gap_m},
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
  if (counts.at_limit > 0) json["shots_at_work_limit"] = counts.at_limit;
  if (counts.of_several > 0) json["first_of_several"] = place_json(counts.several);
  return json;
}

std::vector<std::string> refraction_warnings(const Survey& survey, const SimulationStats& stats) {
  const StraighteningCounts& counts = stats.refraction;
  std::vector<std::string> warnings;
  const auto at = [](const std::array<double, 3>& place) {
    return fmt::format("the first at azimuth {:.1f} and elevation {:.1f} degrees, {:.4g} m away", place[0],
                       place[1], place[2]);
  };
  const std::string where = to_string(survey.scene.description.water.place);
  if (counts.in_shadow > 0)
    warnings.push_back(
        fmt::format("{}: {} apparent facets of {} pings are left out: no ray leads to them, or to a part of "
                    "them (a shadow zone); {}",
                    where, counts.in_shadow, stats.shadowed_pings, at(counts.shadow)));
  if (counts.of_several > 0)
    warnings.push_back(
        fmt::format("{}: several rays lead to {} apparent facets: only the first to arrive, with one turning "
                    "point at most, is followed; {}",
                    where, counts.of_several, at(counts.several)));
  if (counts.folded > 0)
    warnings.push_back(
        fmt::format("{}: {} apparent facets are turned over: rays cross before them (a "
                    "caustic), and energies there are not to be relied on",
                    where, counts.folded));
  if (counts.unbounded > 0)
    warnings.push_back(fmt::format(
        "{}: {} bins have no bound (energy_bound is infinite): facets to which it is not proven that "
        "exactly one ray leads may be heard in them, or hide what is",
        where, counts.unbounded));
  const std::optional<double> asked_m = survey.scene.description.water.refraction_gap_m;
  if (asked_m && counts.largest_gap_m > *asked_m)
    warnings.push_back(fmt::format(
        "{}: 'refraction_gap_m' asks for {:.3g} m, {:.3g} m is kept: edges next to a caustic or a "
        "shadow, or as short as the grid allows, are not cut further",
        where, *asked_m, counts.largest_gap_m));
  if (counts.at_limit > 0)
    warnings.push_back(
        fmt::format("{}: bounds of {} shots are true but wider than asked: narrower ones take more apparent "
                    "facets than a reference makes; raise --tolerance",
                    where, counts.at_limit));
  return warnings;
}

}  // namespace tubefoot
