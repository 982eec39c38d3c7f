// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <optional>
#include <set>

#include "engine/surface/surface_mesh.hpp"
#include "files/limits.hpp"
#include "files/memory_at_hand.hpp"
#include "geometry/mesh/merged_planes.hpp"
#include "geometry/steps/steps.hpp"
#include "geometry/tubes/mirror.hpp"
#include "run/coarsening.hpp"
#include "run/motion_within_ping.hpp"
#include "run/paths.hpp"
#include "run/recorded_navigation.hpp"
#include "run/refraction.hpp"
#include "run/scene_below.hpp"
#include "run/sensor_places.hpp"
#include "run/transmission_surface.hpp"
#include "run/volume_part.hpp"
#include "run/water_targets.hpp"
#include "scene/ping_times.hpp"
#include "sensors/recordings/sensor_kind.hpp"

// This file opens a survey. It loads the scene, places all pings on their trajectories and checks the
// positions. It also merges and coarsens facets, and groups sensors that share their transmissions.

namespace tubefoot {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool same_transmissions(const WorldGrid& grid, const SensorPings& a, const SensorPings& b) {
  if (a.times_s != b.times_s || a.sensor->transmissions() != b.sensor->transmissions()) return false;
  // The echo of an apparent facet includes the absorption along its ray, which depends on the frequency.
  if (!a.water.empty() && a.sound_speed_m_s != b.sound_speed_m_s) return false;
  for (std::size_t t = 0; !a.water.empty() && t < a.sensor->transmissions(); ++t)
    if (a.sensor->frequency_khz(t) != b.sensor->frequency_khz(t) ||
        a.sensor->own_absorption_db_per_km(t) != b.sensor->own_absorption_db_per_km(t))
      return false;
  if (a.sensor->has_separate_receiver() || b.sensor->has_separate_receiver()) return false;  // two apexes
  if (a.transmission_poses != b.transmission_poses) return false;
  for (std::size_t transmission = 0; transmission < a.sensor->transmissions(); ++transmission) {
    TubeSet first = a.sensor->tubes(a.transmission_pose(0, transmission), grid, transmission);
    TubeSet second = b.sensor->tubes(b.transmission_pose(0, transmission), grid, transmission);
    first.reach = second.reach = 0;
    if (first != second) return false;
  }
  return true;
}

void find_shared_transmissions(const WorldGrid& grid, SensorSet& sensor_set) {
  for (std::size_t s = 0; s < sensor_set.sensors.size(); ++s) {
    const auto group = std::find_if(
        sensor_set.transmissions.begin(), sensor_set.transmissions.end(), [&](const SharedTransmissions& g) {
          return same_transmissions(grid, sensor_set.sensors[g.sensors.front()], sensor_set.sensors[s]);
        });
    if (group != sensor_set.transmissions.end())
      group->sensors.push_back(s);
    else
      sensor_set.transmissions.push_back({{s}});
  }
}

/// Places the pings on a trajectory. A fixed trajectory has no end. For others, the loader has checked that
/// they cover the times of the pings.
void place_transmissions(SensorPings& pings, const Trajectory& trajectory) {
  const Sensor& sensor = *pings.sensor;
  const std::size_t transmissions = pings.times_s.size() * sensor.transmissions();
  pings.poses.reserve(pings.times_s.size());
  pings.transmission_poses.reserve(transmissions);
  if (sensor.has_separate_receiver()) pings.receiver_poses.reserve(transmissions);
  for (std::size_t t = 0; t < sensor.transmit_sectors().size(); ++t)
    if (const double delay_s = sensor.transmission_delay_s(sensor.first_transmission(t));
        pings.times_s.size() > 1 && delay_s >= sensor.description().shortest_interval_s())
      throw InputError(
          sensor.description().place,
          fmt::format("sector {} of sensor '{}' has a delay of {} s, which is longer than the "
                      "ping: it must be below the time between pings, which is {} s",
                      t, sensor.description().name, delay_s, sensor.description().shortest_interval_s()));
  Steps placed("pings placed", pings.times_s.size());
  for (const double time_s : pings.times_s) {
    placed.done();
    pings.poses.push_back(sensor.pose_on(trajectory.at(time_s)));
    for (std::size_t transmission = 0; transmission < sensor.transmissions(); ++transmission) {
      const double at_s = time_s + sensor.transmission_delay_s(transmission);
      if (!trajectory.is_fixed() && at_s > trajectory.end_s() &&
          sensor.transmission_delay_s(transmission) > 0)
        throw InputError(
            sensor.description().place,
            fmt::format("transmission {} of the ping at {:.9g} s of sensor '{}' is sent at {:.9g} s, but the "
                        "trajectory ends at {:.9g} s: use fewer pings or a longer trajectory",
                        transmission, time_s, sensor.description().name, at_s, trajectory.end_s()));
      pings.transmission_poses.push_back(steered_pose(sensor, trajectory, at_s, transmission));
      if (sensor.has_separate_receiver())
        pings.receiver_poses.push_back(steered_receiver_pose(
            sensor, trajectory, time_s + sensor.reception_delay_s(transmission), transmission));
    }
  }
}

/// Warns about the precision of energies in narrow beams.
void warn_of_rounding(const Sensor& sensor, std::vector<std::string>& warnings) {
  constexpr double worth_telling = 1e-4;
  if (sensor.wall_rounding() > worth_telling)
    warnings.push_back(fmt::format(
        "{}: sensor '{}' has very narrow beams: the rounding of directions to 2^-30 can change their width "
        "and energy by a fraction of {:.2g}",
        to_string(sensor.description().place), sensor.description().name, sensor.wall_rounding()));
}

/// Warns about an implausible antenna. Its length is the wavelength divided by the beam width in radians.
void warn_of_aperture(const SensorPings& pings, std::vector<std::string>& warnings) {
  constexpr double longest_m = 18;  // longest antennas under ships, for 12 kHz
  const SensorFigures figures = figures_of(pings.sensor->description());
  const double wavelength_m = pings.sound_speed_m_s / (1000 * figures.frequency_khz),
               antenna_m = wavelength_m / glm::radians(figures.beam_deg);
  if (antenna_m > longest_m)
    warnings.push_back(
        fmt::format("{}: sensor '{}' has beams of {:.3g} degrees at {:.4g} kHz, which need an antenna of "
                    "{:.3g} m: is 'frequency_khz' in kHz, and are the beam widths in degrees?",
                    to_string(pings.sensor->description().place), pings.sensor->description().name,
                    figures.beam_deg, figures.frequency_khz, antenna_m));
}

/// Warns about sensors that move too far during a ping. Must follow check_places(), which finds altitudes.
void warn_of_motion(LoadedScene& loaded_scene, const SensorSet& sensor_set) {
  Scene& scene = loaded_scene.scene;
  for (std::size_t s = 0; s < sensor_set.sensors.size(); ++s)
    if (const auto warning =
            motion_warning(sensor_set.sensors[s], scene.trajectories[scene.sensor_trajectory[s]]))
      scene.report.warnings.push_back(*warning);
}

/// Throws InputError for elements of an array that are not in the water, because each element receives at
/// its own position.
void refuse_hidden_elements(const Scene& scene, const SensorPings& pings, std::size_t ping,
                            SensorPlaces& places) {
  const SensorDescription& description = pings.sensor->description();
  const ElementArray& array = pings.sensor->signals()->array;
  const Pose &sent = pings.transmission_pose(ping, 0), &received = pings.receiver_pose(ping, 0);
  const std::array transmitters_m{sent.position_m + sent.attitude * array.transmitter_m};
  std::vector<glm::dvec3> receivers_m;
  for (const glm::dvec3 place : array.receivers_m)
    receivers_m.push_back(received.position_m + received.attitude * place);
  places.refuse_hidden(
      {description.place, description.name, ping, pings.times_s[ping], transmitters_m, receivers_m});
  if (!scene.description.sea_surface) return;
  const double height_m = scene.description.sea_surface->height_m;
  for (std::size_t k = 0; k < receivers_m.size(); ++k)
    if (receivers_m[k].z >= height_m)
      throw InputError(
          description.place,
          fmt::format("receiver {} of sensor '{}' is {:.3g} m above the sea surface at ping {} "
                      "(t = {:.3f} s): lower its trajectory or lever arm, or move the receiver",
                      k, description.name, receivers_m[k].z - height_m, ping, pings.times_s[ping]));
}

void check_places(LoadedScene& loaded_scene, SensorSet& sensor_set) {
  SensorPlaces places(loaded_scene);
  for (SensorPings& pings : sensor_set.sensors) {
    const Sensor& sensor = *pings.sensor;
    std::set<std::uint16_t> inside, receiver_inside;
    const std::string what = fmt::format("sensor '{}'", sensor.description().name),
                      receiver = "the receiver of " + what;
    const auto at = [&](std::size_t ping, glm::dvec3 at_m, const std::string& called) {
      return PingPlace{sensor.description().place, ping, pings.times_s[ping], at_m, called};
    };
    const bool objects_move = loaded_scene.moving != nullptr;
    pings.altitudes_m.reserve(pings.poses.size());
    Steps seen("comparing sensor positions with the seabed", pings.poses.size());
    for (std::size_t ping = 0; ping < pings.poses.size(); ++ping) {
      seen.done();
      pings.altitudes_m.push_back(places.check(at(ping, pings.poses[ping].position_m, what), inside));
      if (sensor.has_separate_receiver())
        places.check(at(ping, pings.receiver_pose(ping, 0).position_m, receiver), receiver_inside);
      if (sensor.has_receiver_pair())
        for (const ReceiverBaseline& receiver_pair :
             sensor.patterns(pings.receiver_pose(ping, 0), pings.sound_speed_m_s, 0).baselines)
          for (const double end : {1.0, -1.0})
            places.check(at(ping,
                            pings.receiver_pose(ping, 0).position_m +
                                end * receiver_pair.baseline_m / 2 * receiver_pair.axis,
                            fmt::format("the {} receiver of {}", end > 0 ? "upper" : "lower", what)),
                         receiver_inside);
      if (sensor.signals() != nullptr) refuse_hidden_elements(loaded_scene.scene, pings, ping, places);
      // For later transmissions of a ping, only positions on a facet are errors.
      for (std::size_t transmission = 1; transmission < sensor.transmissions(); ++transmission) {
        const auto check = [&](const Pose& now, const Pose& before, const std::string& who) {
          const bool same_time =
              sensor.transmission_delay_s(transmission) == sensor.transmission_delay_s(transmission - 1);
          if (now.position_m == before.position_m && (same_time || !objects_move)) return;
          PingPlace where = at(ping, now.position_m, who);
          where.time_s += sensor.transmission_delay_s(transmission);
          places.refuse_on_facet(where);
        };
        check(pings.transmission_pose(ping, transmission), pings.transmission_pose(ping, transmission - 1),
              what);
        if (sensor.has_separate_receiver())
          check(pings.receiver_pose(ping, transmission), pings.receiver_pose(ping, transmission - 1),
                receiver);
      }
    }
  }
}

/// Returns whether the sea surface cuts the terrain or an object at rest. For a part of a loaded scene,
/// returns whether it cuts the whole scene.
bool reaches_surface(const LoadedScene& loaded_scene) {
  if (loaded_scene.whole) return loaded_scene.whole->is_cut;
  const Scene& scene = loaded_scene.scene;
  if (!scene.description.sea_surface || loaded_scene.surface_mesh)
    return false;  // each transmission cuts its own surface
  const std::int32_t height = scene.surface_height();
  std::size_t at_rest = scene.mesh.vertices.size();
  for (const MovingObject& object : scene.moving) at_rest -= object.points_m.size();
  return std::any_of(scene.mesh.vertices.begin(),
                     scene.mesh.vertices.begin() + static_cast<std::ptrdiff_t>(at_rest),
                     [=](GridPoint v) { return v.z > height; }) ||
         std::ranges::any_of(scene.tiled, [&](const TiledTerrain& terrain) {
           const double lift_m =
               loaded_scene.relief.omitted ? loaded_scene.relief.omitted->largest_height_m() : 0;
           return terrain.tiles &&
                  scene.grid.snap(terrain.tiles->hi_m() + glm::dvec3(0, 0, lift_m)).z > height;
         });
}

/// Removes everything above the water. Must follow check_places(), which counts crossings of whole objects.
void cut_at_surface(LoadedScene& loaded_scene) {
  loaded_scene.is_cut = reaches_surface(loaded_scene);
  if (!loaded_scene.is_cut) return;
  // Each transmission cuts moving objects at its own time.
  Scene& scene = loaded_scene.scene;
  std::vector<FacetId>& parent = loaded_scene.relief.parent;
  const FacetId first = first_moving_facet(scene, scene.mesh);
  std::vector<FacetId> parent_of_moving;
  if (!parent.empty()) {
    parent_of_moving.assign(parent.begin() + first, parent.end());
    parent.resize(first);
  }
  drop_moving(scene, scene.mesh);
  const bool was_cut = cut_at_surface(scene, scene.mesh, parent);
  add_moving(scene, scene.first_ping_s, scene.mesh);
  parent.insert(parent.end(), parent_of_moving.begin(), parent_of_moving.end());
  if (was_cut) build_tree(loaded_scene);
}

/// Returns whether facets must stay as they are loaded. Relief has parents of facets, tiles have facet
/// numbers, refracted facets bend, and moving facets have vertices of their own. Sound that scatters
/// repeatedly treats each facet as a point.
bool keeps_its_facets(const LoadedScene& loaded_scene) {
  return loaded_scene.is_tiled() || loaded_scene.relief.cell_m > 0 || loaded_scene.scene.water->refracts() ||
         loaded_scene.moving != nullptr || loaded_scene.scene.description.paths.scatterings > 1;
}

void merge_planes(LoadedScene& loaded_scene) {
  std::optional<FacetMesh> merged = with_planes_merged(loaded_scene.scene.mesh);
  if (!merged) return;
  loaded_scene.facets_given = loaded_scene.scene.mesh.facets.size();
  loaded_scene.scene.mesh = std::move(*merged);
  loaded_scene.tree = std::make_unique<SceneTree>(loaded_scene.scene.mesh);
}

/// Checks the requirements of signals on the scene.
void check_signals(const Scene& scene, const SensorPings& pings, const SignalModel& model,
                   const Trajectory& trajectory) {
  const SensorDescription& description = pings.sensor->description();
  try {
    check_wavelength(model.waveform, pings.sound_speed_m_s, scene.grid.unit_m());
  } catch (const std::invalid_argument& error) {
    throw InputError(description.place, fmt::format("sensor '{}': {}", description.name, error.what()));
  }
  if (!model.stop_and_hop && path_settings(scene, pings.sensor->frequency_khz()))
    throw InputError(
        description.place,
        fmt::format(
            "sensor '{}' moves during reception (stop_and_hop = false), but tubefoot computes paths via "
            "mirrors only for a sensor at rest: set stop_and_hop = true, or leave out the mirrors",
            description.name));
  if (!model.stop_and_hop &&
      std::ranges::any_of(scene.smooth, [](const auto& surface) { return surface.has_value(); }))
    throw InputError(
        description.place,
        fmt::format(
            "sensor '{}' moves during reception (stop_and_hop = false), but tubefoot computes echoes of "
            "smooth materials only for a sensor at rest: set stop_and_hop = true, or leave out 'smooth'",
            description.name));
  const double end_s = pings.times_s.back() + model.sampling.end_s();
  if (!model.stop_and_hop && !trajectory.is_fixed() && !trajectory.holds(end_s))
    throw InputError(
        description.place,
        fmt::format("sensor '{}' moves during reception (stop_and_hop = false): its last sample is at {:.9g} "
                    "s, but the trajectory ends at {:.9g} s: use fewer pings or a longer trajectory",
                    description.name, end_s, trajectory.end_s()));
}

/// Checks a sensor that moves during a ping.
void check_division(const Scene& scene, const Sensor& sensor, const Trajectory& trajectory,
                    std::size_t pings) {
  const SensorDescription& description = sensor.description();
  if (pings * sensor.transmissions() > static_cast<std::size_t>(limits::sensor_transmissions))
    throw InputError(
        description.place,
        fmt::format("the motion of sensor '{}' needs {} transmissions per ping for its intervals, "
                    "and at most {} are allowed for all pings: increase 'motion_step_beams', or "
                    "use fewer pings",
                    description.name, sensor.transmissions(), limits::sensor_transmissions));
  for (const MovingObject& object : scene.moving)
    if (!object.waves && &scene.trajectories[object.trajectory] == &trajectory)
      throw InputError(
          description.place,
          fmt::format(
              "sensor '{}' moves during a ping (stop_and_hop = false), but object '{}' on its "
              "trajectory has the pose of the transmission until the echo arrives: set stop_and_hop = "
              "true, or remove 'trajectory' from the object",
              description.name, scene.report.components[object.component].name));
}

SensorPings pings_of(LoadedScene& loaded_scene, const SensorDescription& description,
                     const Trajectory& trajectory) {
  SensorPings pings;
  pings.sound_speed_m_s = sound_speed_at(loaded_scene.scene, description, trajectory);
  std::unique_ptr<Sensor> sensor =
      make_sensor(in_water(description, pings.sound_speed_m_s, &loaded_scene.scene.report.warnings));
  const PingTimes times(description, trajectory, description.trajectory);
  pings.times_s = times.times_s();
  if (!description.stop_and_hop && sensor->signals() == nullptr)
    if (const auto division = division_of_record(*sensor, trajectory, pings.times_s, pings.sound_speed_m_s)) {
      sensor->divide_record(*division);
      check_division(loaded_scene.scene, *sensor, trajectory, pings.times_s.size());
    }
  pings.sensor = std::move(sensor);
  const auto count = static_cast<double>(times.count());
  const double transmissions = static_cast<double>(pings.sensor->transmissions()) * count;
  require_memory(transmissions * sizeof(SteeredPose) * (pings.sensor->has_separate_receiver() ? 2 : 1) +
                     count * (sizeof(Pose) + 2.0 * sizeof(double)),
                 description.place, fmt::format("the poses of {:.3g} transmissions", transmissions),
                 "reduce the number of pings per scene");
  pings.line_starts = times.line_starts();
  place_transmissions(pings, trajectory);
  if (const SignalModel* model = pings.sensor->signals())
    check_signals(loaded_scene.scene, pings, *model, trajectory);
  warn_of_rounding(*pings.sensor, loaded_scene.scene.report.warnings);
  warn_of_aperture(pings, loaded_scene.scene.report.warnings);
  return pings;
}

}  // namespace

std::unique_ptr<const Survey> open_survey(const SceneDescription& description, Facets facets,
                                          double coarseness) {
  const auto load_start = std::chrono::steady_clock::now();
  const auto loaded_scene = std::make_shared<LoadedScene>(load_scene(description));
  if (loaded_scene->is_tiled()) loaded_scene->terrain_use = std::make_shared<TerrainUse>();
  loaded_scene->load_seconds = seconds_since(load_start);
  lay_relief(*loaded_scene);
  const auto tree_start = std::chrono::steady_clock::now();
  build_tree(*loaded_scene);
  loaded_scene->tree_seconds = seconds_since(tree_start);
  const auto sensor_set = std::make_shared<SensorSet>();
  for (std::size_t s = 0; s < description.sensors.size(); ++s)
    sensor_set->sensors.push_back(
        pings_of(*loaded_scene, description.sensors[s],
                 loaded_scene->scene.trajectories[loaded_scene->scene.sensor_trajectory[s]]));
  assume_configuration(loaded_scene->scene, *sensor_set);
  check_places(*loaded_scene, *sensor_set);
  warn_of_motion(*loaded_scene, *sensor_set);
  loaded_scene->targets = load_water_targets(loaded_scene->scene);
  check_water_targets(*loaded_scene, *sensor_set);
  // Must follow check_places(), whose messages name the facets under a sensor.
  if (facets == Facets::merged && !keeps_its_facets(*loaded_scene)) {
    merge_planes(*loaded_scene);
    if (coarseness > 0) coarsen(*loaded_scene, *sensor_set, coarseness);
  }
  cut_at_surface(*loaded_scene);
  put_into_water(*loaded_scene, *sensor_set);
  check_paths(loaded_scene->scene, *sensor_set);
  find_shared_transmissions(loaded_scene->scene.grid, *sensor_set);
  check_volume(*loaded_scene, *sensor_set);
  return std::unique_ptr<const Survey>(new Survey{loaded_scene, sensor_set});
}

Survey survey_with_tiles(const Survey& survey, const TileChoice& choice) {
  const std::shared_ptr<LoadedScene> part = loaded_with(*survey.loaded_scene, choice);
  if (survey.loaded_scene->refines_tiles()) refine_part(*survey.loaded_scene, choice, *part);
  build_tree(*part);
  part->lowest_m = survey.loaded_scene->lowest_m;
  part->whole = survey.loaded_scene;
  part->targets = survey.loaded_scene->targets;
  part->tiles = choice;
  cut_at_surface(*part);
  return {part, survey.sensor_set};
}

double absorption_db_per_m(const Scene& scene, const Sensor& sensor) {
  return absorption_db_per_km(scene.description.water, sensor.frequency_khz()) / 1000;
}

double absorption_db_per_m(const Scene& scene, const Sensor& sensor, std::size_t transmission) {
  if (const auto own = sensor.own_absorption_db_per_km(transmission)) return *own / 1000;
  return absorption_db_per_km(scene.description.water, sensor.frequency_khz(transmission)) / 1000;
}

}  // namespace tubefoot
