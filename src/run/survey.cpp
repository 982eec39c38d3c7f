// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <optional>
#include <set>
#include <span>

#include "files/memory_at_hand.hpp"
#include "files/usage_error.hpp"
#include "geometry/search/vertical_line.hpp"
#include "geometry/tubes/mirror.hpp"
#include "geometry/work/steps.hpp"
#include "run/paths.hpp"
#include "run/refraction.hpp"
#include "run/shot_ground.hpp"
#include "run/tiles_in_view.hpp"
#include "sensors/products/in_water.hpp"

namespace tubefoot {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool same_shots(const Survey& survey, const SensorPings& a, const SensorPings& b) {
  // Facets return by their rays' absorption, which goes by the frequency.
  if (a.water &&
      (a.sensor->frequency_khz() != b.sensor->frequency_khz() || a.sound_speed_m_s != b.sound_speed_m_s))
    return false;
  if (a.times_s != b.times_s || a.sensor->shots() != b.sensor->shots()) return false;
  if (a.sensor->has_receiver_apart() || b.sensor->has_receiver_apart()) return false;  // two apexes
  const auto same = [](const Pose& p, const Pose& q) {
    return p.position_m == q.position_m && p.attitude == q.attitude;
  };
  if (!std::equal(a.shot_poses.begin(), a.shot_poses.end(), b.shot_poses.begin(), same)) return false;
  for (std::size_t shot = 0; shot < a.sensor->shots(); ++shot) {
    TubeSet first = a.sensor->tubes(a.shot_pose(0, shot), survey.scene.grid, shot);
    TubeSet second = b.sensor->tubes(b.shot_pose(0, shot), survey.scene.grid, shot);
    first.reach = second.reach = 0;
    if (first != second) return false;
  }
  return true;
}

void find_shared_shots(Survey& survey) {
  for (std::size_t s = 0; s < survey.sensors.size(); ++s) {
    const auto group = std::find_if(survey.shots.begin(), survey.shots.end(), [&](const SharedShots& g) {
      return same_shots(survey, survey.sensors[g.sensors.front()], survey.sensors[s]);
    });
    if (group != survey.shots.end())
      group->sensors.push_back(s);
    else
      survey.shots.push_back({{s}});
  }
}

/// A fixed trajectory lasts for ever; of others the loader has checked that they cover the pings' times.
void place_shots(SensorPings& pings, const Trajectory& trajectory) {
  const Sensor& sensor = *pings.sensor;
  const std::size_t shots = pings.times_s.size() * sensor.shots();
  pings.poses.reserve(pings.times_s.size());
  pings.shot_poses.reserve(shots);
  if (sensor.has_receiver_apart()) pings.receiver_poses.reserve(shots);
  Steps placed("pings placed", pings.times_s.size());
  for (const double time_s : pings.times_s) {
    placed.done();
    pings.poses.push_back(sensor.pose_on(trajectory.at(time_s)));
    for (std::size_t shot = 0; shot < sensor.shots(); ++shot) {
      const double at_s = time_s + sensor.shot_delay_s(shot);
      if (!trajectory.is_fixed() && at_s > trajectory.end_s() && sensor.shot_delay_s(shot) > 0)
        throw InputError(
            sensor.description().place,
            fmt::format("shot {} of the ping at {:.9g} s of sensor '{}' is fired at {:.9g} s, after "
                        "its trajectory ends at {:.9g} s: ask for fewer pings or a longer trajectory",
                        shot, time_s, sensor.description().name, at_s, trajectory.end_s()));
      const Pose carrier = trajectory.at(at_s);
      pings.shot_poses.push_back(sensor.pose_on(carrier));
      if (sensor.has_receiver_apart()) pings.receiver_poses.push_back(sensor.receiver_pose_on(carrier));
    }
  }
}

/// A scene with some tiles, and what shots ask of its facets.
std::unique_ptr<Survey> loaded_with(const Survey& survey, const TileChoice& choice) {
  auto part = std::make_unique<Survey>(with_tiles(survey.scene, choice));
  part->relief = survey.relief;
  if (survey.ground) part->ground = relief_ground(part->scene);
  return part;
}

/// The facets above and below one place after the other.
class Patch {
 public:
  explicit Patch(const Survey& survey) : survey_(survey) {
    if (survey.is_tiled()) tiles_.emplace(survey);
  }
  const Survey& in_line_with(glm::dvec3 place_m) {
    if (!tiles_) return survey_;
    TileChoice choice = tiles_->below(place_m);
    if (!part_ || choice != choice_) {
      choice_ = std::move(choice);
      part_ = loaded_with(survey_, choice_);
      part_->tree = std::make_unique<SceneTree>(part_->scene.mesh, SceneTree::Sheets::ignored);
    }
    return *part_;
  }

 private:
  const Survey& survey_;
  std::optional<TilesInView> tiles_;
  TileChoice choice_;
  std::unique_ptr<Survey> part_;
};

/// Of narrow beams: what their energies are worth.
void warn_of_rounding(const Sensor& sensor, std::vector<std::string>& warnings) {
  constexpr double worth_telling = 1e-4;
  if (sensor.wall_rounding() > worth_telling)
    warnings.push_back(fmt::format(
        "{}: sensor '{}' has beams so narrow that the rounding of directions to 2^-30 may be {:.2g} "
        "of their width, and of their energy",
        to_string(sensor.description().place), sensor.description().name, sensor.wall_rounding()));
}

std::vector<FacetId> facets_above_and_below(const ShotGround& ground, GridPoint point) {
  std::vector<FacetId> near;
  facets_near_vertical(ground.tree(), point, near);
  return near;
}

/// A surface through the apex has no side that could be seen, hides nothing, and returns nothing: that is no
/// limit of what a sensor beside it hears, so it is no place for one.
void refuse_on_facet(const Survey& survey, const ShotGround& ground, std::span<const FacetId> near,
                     const SensorPings& pings, std::size_t ping, glm::dvec3 at_m, const std::string& what) {
  const Scene& scene = survey.scene;
  const std::optional<FacetContact> contact = contact_at(ground.mesh(), near, scene.grid.snap(at_m));
  if (!contact) return;
  constexpr std::array<const char*, 3> parts{"a vertex", "an edge", "a facet"};
  throw InputError(
      pings.sensor->description().place,
      fmt::format(
          "{} lies exactly on {} of '{}' at ping {} (t = {:.3f} s, east {:.6f}, north {:.6f}, up {:.6f} "
          "m), from where it shows no side: move it off by as much as its housing keeps it off, a "
          "millimetre will do ('lever_arm_m', or the trajectory)",
          what, parts[static_cast<std::size_t>(contact->part)],
          scene.report.components[contact->component].name, ping, pings.times_s[ping], at_m.x, at_m.y,
          at_m.z));
}

/// Looks straight up and down from a place of a sensor's transmitter or receiver (`what`). One under the
/// terrain is a mistake in the scene; one inside an object may be in its own housing. Returns the altitude
/// over the terrain, not a number where there is none.
double check_place(Survey& survey, Patch& patch, const SensorPings& pings, std::size_t ping, glm::dvec3 at_m,
                   const std::string& what, std::set<std::uint16_t>& inside) {
  Scene& scene = survey.scene;
  double altitude_m = std::numeric_limits<double>::quiet_NaN();
  const SourcePlace& place = pings.sensor->description().place;
  const ShotGround ground = ground_in_line_with(patch.in_line_with(at_m), at_m);
  const std::vector<FacetId> near = facets_above_and_below(ground, scene.grid.snap(at_m));
  refuse_on_facet(survey, ground, near, pings, ping, at_m, what);
  for (const VerticalCrossings& c : vertical_crossings(ground.mesh(), near, scene.grid.snap(at_m))) {
    const std::string& name = scene.report.components[c.component].name;
    if (c.component < scene.description.terrains.size()) {
      if (c.above > 0 && c.below == 0)
        throw InputError(
            place, fmt::format("{} is {:.3g} m below the seabed ('{}') at ping {} (t = {:.3f} s, "
                               "east {:.2f}, north {:.2f}, up {:.2f} m): raise its trajectory or lever "
                               "arm",
                               what, c.lowest_above * scene.grid.unit_m(), name, ping, pings.times_s[ping],
                               at_m.x, at_m.y, at_m.z));
      if (c.below > 0) altitude_m = std::fmin(altitude_m, c.highest_below * scene.grid.unit_m());
    } else if (c.above % 2 == 1 && inside.insert(c.component).second) {
      scene.report.warnings.push_back(fmt::format(
          "{}: {} is inside object '{}' at ping {} (t = {:.3f} s): it sees the object's inner side",
          to_string(place), what, name, ping, pings.times_s[ping]));
    }
  }
  return altitude_m;
}

void check_places(Survey& survey) {
  Patch patch(survey);
  for (SensorPings& pings : survey.sensors) {
    const Sensor& sensor = *pings.sensor;
    std::set<std::uint16_t> inside, receiver_inside;
    const std::string what = fmt::format("sensor '{}'", sensor.description().name);
    pings.altitudes_m.reserve(pings.poses.size());
    Steps seen("pings held against the bed", pings.poses.size());
    for (std::size_t ping = 0; ping < pings.poses.size(); ++ping) {
      seen.done();
      pings.altitudes_m.push_back(
          check_place(survey, patch, pings, ping, pings.poses[ping].position_m, what, inside));
      if (sensor.has_receiver_apart())
        check_place(survey, patch, pings, ping, pings.receiver_pose(ping, 0).position_m,
                    "the receiver of " + what, receiver_inside);
      if (sensor.has_staff())
        for (const Fringe& staff : sensor.patterns(pings.poses[ping], pings.sound_speed_m_s, 0).fringes)
          for (const double end : {1.0, -1.0})
            check_place(survey, patch, pings, ping,
                        pings.poses[ping].position_m + end * staff.baseline_m / 2 * staff.axis,
                        fmt::format("the {} receiver of {}", end > 0 ? "upper" : "lower", what),
                        receiver_inside);
      // Of the later shots of a ping only what would spoil them.
      for (std::size_t shot = 1; shot < sensor.shots(); ++shot) {
        const auto check = [&](glm::dvec3 at_m, glm::dvec3 before_m, const std::string& who) {
          if (at_m == before_m) return;
          const ShotGround ground = ground_in_line_with(patch.in_line_with(at_m), at_m);
          refuse_on_facet(survey, ground, facets_above_and_below(ground, survey.scene.grid.snap(at_m)), pings,
                          ping, at_m, who);
        };
        check(pings.shot_pose(ping, shot).position_m, pings.shot_pose(ping, shot - 1).position_m, what);
        if (sensor.has_receiver_apart())
          check(pings.receiver_pose(ping, shot).position_m, pings.receiver_pose(ping, shot - 1).position_m,
                "the receiver of " + what);
      }
    }
  }
}

/// Leaves what is in the water. After check_places(), which counts the crossings of whole objects.
void cut_at_surface(Survey& survey) {
  Scene& scene = survey.scene;
  if (!scene.description.sea_surface || survey.ground) return;  // no path follows ground of its own
  const std::int32_t height = scene.surface_height();
  const auto& vertices = scene.mesh.vertices;
  if (std::all_of(vertices.begin(), vertices.end(), [=](GridPoint v) { return v.z <= height; })) return;
  std::vector<FacetId> all(scene.mesh.facets.size());
  std::iota(all.begin(), all.end(), FacetId{0});
  MeshPart wet = in_front_of(MirrorPlane::horizontal(height), scene.mesh, all);
  scene.mesh = std::move(wet.mesh);
  if (!survey.relief.parent.empty()) {
    for (FacetId& facet : wet.origin) facet = survey.relief.parent[facet];
    survey.relief.parent = std::move(wet.origin);
  }
  survey.tree = std::make_unique<SceneTree>(scene.mesh);
}

/// Half of the path from transmitter to receiver is no less than the range from either of them, less half of
/// the way between them.
TubeSet reaching_beyond(const SensorPings& pings, std::size_t ping, std::size_t shot, double unit_m,
                        TubeSet set) {
  set.reach +=
      glm::distance(pings.shot_pose(ping, shot).position_m, pings.receiver_pose(ping, shot).position_m) /
      (2 * unit_m);
  return set;
}

}  // namespace

Survey::Survey(Scene loaded) : scene(std::move(loaded)) {}
Survey::~Survey() = default;

TubeSet Survey::receive_tubes(std::size_t s, std::size_t ping, std::size_t shot) const {
  const SensorPings& pings = sensors[s];
  return reaching_beyond(pings, ping, shot, scene.grid.unit_m(),
                         pings.sensor->tubes(pings.receiver_pose(ping, shot), scene.grid, shot));
}

TubeSet Survey::tubes(const SharedShots& group, std::size_t ping, std::size_t shot) const {
  const SensorPings& first = sensors[group.sensors.front()];
  TubeSet set = first.sensor->tubes(first.shot_pose(ping, shot), scene.grid, shot);
  for (const std::size_t s : group.sensors)
    set.reach = std::max(set.reach, sensors[s].sensor->reach(scene.grid));
  return reaching_beyond(first, ping, shot, scene.grid.unit_m(), std::move(set));
}

std::size_t Survey::sensor_named(const std::string& name) const {
  std::string names;
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    const std::string& own = sensors[s].sensor->description().name;
    if (own == name) return s;
    names += (s == 0 ? "'" : ", '") + own + "'";
  }
  throw UsageError(fmt::format("the scene has no sensor '{}'; it has {}", name, names));
}

std::unique_ptr<Survey> survey_with_tiles(const Survey& survey, const TileChoice& choice) {
  auto part = loaded_with(survey, choice);
  part->tree = std::make_unique<SceneTree>(part->scene.mesh);
  part->lowest_m = survey.lowest_m;
  part->sensors = survey.sensors;
  part->shots = survey.shots;
  part->watch = survey.watch;
  cut_at_surface(*part);
  return part;
}

std::unique_ptr<Survey> open_survey(const SceneDescription& description) {
  const auto load_start = std::chrono::steady_clock::now();
  auto survey = std::make_unique<Survey>(load_scene(description));
  if (survey->is_tiled()) survey->terrain_use = std::make_shared<TerrainUse>();
  survey->load_seconds = seconds_since(load_start);
  lay_relief(*survey);
  const auto tree_start = std::chrono::steady_clock::now();
  survey->tree = std::make_unique<SceneTree>(survey->scene.mesh);
  survey->tree_seconds = seconds_since(tree_start);
  for (std::size_t s = 0; s < description.sensors.size(); ++s) {
    SensorPings pings;
    const Trajectory& trajectory = survey->scene.trajectories[survey->scene.sensor_trajectory[s]];
    pings.sound_speed_m_s = sound_speed_at(*survey, description.sensors[s], trajectory);
    pings.sensor =
        make_sensor(in_water(description.sensors[s], pings.sound_speed_m_s, &survey->scene.report.warnings));
    const double shots = static_cast<double>(pings.sensor->shots()) * description.sensors[s].pings;
    require_memory(shots * sizeof(Pose) * (pings.sensor->has_receiver_apart() ? 2 : 1) +
                       description.sensors[s].pings * (sizeof(Pose) + 2.0 * sizeof(double)),
                   description.sensors[s].place, fmt::format("the poses of {:.3g} shots", shots),
                   "ask for fewer pings, in several scenes");
    pings.times_s = pings.sensor->ping_times_s();
    place_shots(pings, trajectory);
    warn_of_rounding(*pings.sensor, survey->scene.report.warnings);
    survey->sensors.push_back(std::move(pings));
  }
  check_places(*survey);
  cut_at_surface(*survey);
  put_into_water(*survey);
  check_paths(*survey);
  find_shared_shots(*survey);
  return survey;
}

double absorption_db_per_m(const Scene& scene, const Sensor& sensor) {
  return absorption_db_per_km(scene.description.water, sensor.frequency_khz()) / 1000;
}

}  // namespace tubefoot
