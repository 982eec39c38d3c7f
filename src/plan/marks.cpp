// SPDX-License-Identifier: GPL-3.0-or-later
// Collects the elements of a scene drawing: sectors of the sensors at selected pings, tracks with headings,
// objects and the extent of the terrain.
#include "plan/marks.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace tubefoot {
namespace {

/// Returns a stride with which at most `most` of `count` items are selected.
std::size_t stride_of(std::size_t count, std::size_t most) {
  return (count + most - 1) / std::max<std::size_t>(most, 1);
}

double angle(glm::dvec3 a, glm::dvec3 b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)); }

/// Divides a tube into cells so narrow that a curved border looks smooth.
void add_cells(glm::dvec3 apex_m, const std::array<glm::dvec3, 4>& ray, std::vector<SectorCell>& cells) {
  constexpr double narrow_rad = 0.07;
  const auto parts = [](double widest) {
    return std::clamp(static_cast<int>(std::ceil(widest / narrow_rad)), 1, 48);
  };
  const int along = parts(std::max(angle(ray[0], ray[1]), angle(ray[3], ray[2]))),
            across = parts(std::max(angle(ray[1], ray[2]), angle(ray[0], ray[3])));
  const auto between = [&](int i, int j) {
    const double u = static_cast<double>(i) / along, v = static_cast<double>(j) / across;
    return glm::normalize((1 - v) * ((1 - u) * ray[0] + u * ray[1]) + v * ((1 - u) * ray[3] + u * ray[2]));
  };
  for (int i = 0; i < along; ++i)
    for (int j = 0; j < across; ++j)
      cells.push_back(
          {apex_m, {between(i, j), between(i + 1, j), between(i + 1, j + 1), between(i, j + 1)}, {}});
}

SectorMark sector_of(const Scene& scene, const SensorPings& pings, std::size_t s, std::size_t ping) {
  const Sensor& sensor = *pings.sensor;
  const RangeSamples& samples = sensor.samples();
  SectorMark sector;
  sector.sensor = s, sector.ping = ping;
  sector.pose = pings.poses[ping];
  sector.first_m = samples.first_m, sector.last_m = samples.first_m + samples.step_m * samples.count;
  constexpr std::size_t most_transmissions = 64, most_tubes = 2048;
  const std::size_t transmission_step = stride_of(sensor.transmissions(), most_transmissions);
  for (std::size_t transmission = 0; transmission < sensor.transmissions();
       transmission += transmission_step) {
    const SteeredPose& pose = pings.transmission_pose(ping, transmission);
    const TubeSet set = sensor.transmit_tubes(pose, scene.grid, transmission);
    const std::size_t tube_step = stride_of(set.tubes.size(), most_tubes);
    for (std::size_t t = 0; t < set.tubes.size(); t += tube_step) {
      std::array<glm::dvec3, 4> rays;
      for (std::size_t k = 0; k < 4; ++k) {
        const GridPoint& ray = set.rays[set.tubes[t][k]];
        rays[k] = glm::normalize(glm::dvec3(ray.x, ray.y, ray.z));
      }
      add_cells(pose.position_m, rays, sector.cells);
    }
    if (sensor.has_separate_receiver())
      sector.receiver_m = pings.receiver_pose(ping, transmission).position_m;
  }
  return sector;
}

void add_sectors(const Survey& survey, std::vector<SectorMark>& sectors) {
  constexpr std::size_t many = 8;
  for (std::size_t s = 0; s < survey.sensors.size(); ++s) {
    const SensorPings& pings = survey.sensors[s];
    const std::size_t count = pings.times_s.size(), middle = count / 2;
    if (count == 0) continue;
    std::vector<std::size_t> chosen{0, count - 1, middle};
    if (survey.sensors.size() > many) chosen = {middle};
    std::ranges::sort(chosen);
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    for (const std::size_t ping : chosen) {
      sectors.push_back(sector_of(survey.scene, pings, s, ping));
      sectors.back().chosen = ping == middle;
    }
  }
}

TrackMark track_of(const Trajectory& trajectory, const SensorPings& pings) {
  TrackMark track;
  const std::size_t count = pings.times_s.size();
  constexpr std::size_t most_points = 20'000, most_headings = 120;
  std::vector<std::size_t> starts = pings.line_starts;
  if (starts.empty() || starts.front() != 0) starts.insert(starts.begin(), 0);
  for (std::size_t line = 0; line < starts.size(); ++line) {
    const std::size_t end = line + 1 < starts.size() ? starts[line + 1] : count;
    if (starts[line] >= end) continue;
    std::vector<glm::dvec3> points;
    for (std::size_t ping = starts[line]; ping < end; ping += stride_of(count, most_points))
      points.push_back(pings.poses[ping].position_m);
    points.push_back(pings.poses[end - 1].position_m);
    track.lines_m.push_back(std::move(points));
  }
  const auto head = [&](std::size_t ping) {
    if (!trajectory.holds(pings.times_s[ping]) && !trajectory.is_fixed()) return;
    const Pose carrier = trajectory.at(pings.times_s[ping]);
    track.headings.push_back({pings.poses[ping].position_m, carrier.attitude * glm::dvec3(0, 1, 0)});
  };
  for (std::size_t ping = 0; ping < count; ping += stride_of(count, most_headings)) head(ping);
  if (count > 1) head(count - 1);
  return track;
}

}  // namespace

SceneMarks marks_of(const Survey& survey, std::span<const SeabedPlacement> placements) {
  const Scene& scene = survey.scene;
  SceneMarks marks;
  marks.terrain = extent_of(scene, Components::terrains);
  const std::size_t terrains = scene.description.terrains.size();
  for (std::size_t i = terrains; i < scene.report.components.size(); ++i) {
    const ComponentReport& object = scene.report.components[i];
    const MovingObject* const sea = moving_sea_surface_of(scene);
    if (object.facets == 0 || (sea != nullptr && sea->component == i)) continue;  // drawn as a line
    const bool buried = i - terrains < placements.size() && placements[i - terrains].is_buried;
    marks.objects.push_back({object.name, i, {object.lo_m, object.hi_m}, buried});
  }
  add_sectors(survey, marks.sectors);
  // Sensors of one carrier have the same track.
  std::vector<std::size_t> drawn;
  for (std::size_t s = 0; s < survey.sensors.size(); ++s) {
    const std::size_t trajectory = scene.sensor_trajectory[s];
    if (survey.sensors[s].times_s.empty() || std::ranges::find(drawn, trajectory) != drawn.end()) continue;
    drawn.push_back(trajectory);
    marks.tracks.push_back(track_of(scene.trajectories[trajectory], survey.sensors[s]));
  }
  return marks;
}

void look_for_seabed(SectorMark& sector, const PlanHeights& seabed, std::optional<double> surface_m) {
  for (SectorCell& cell : sector.cells)
    for (std::size_t k = 0; k < 4; ++k) {
      double& end_m = cell.recorded_to_m[k];
      end_m = seabed.distance_m(cell.apex_m, cell.directions[k], sector.last_m).value_or(sector.last_m);
      if (surface_m && cell.directions[k].z > 0 && cell.apex_m.z <= *surface_m)
        end_m = std::min(end_m, (*surface_m - cell.apex_m.z) / cell.directions[k].z);
    }
}

glm::dvec3 section_direction(const SectorMark& sector) {
  const auto level_or = [](glm::dvec3 way, glm::dvec3 otherwise) {
    way.z = 0;
    return glm::length(way) > 1e-6 ? glm::normalize(way) : otherwise;
  };
  const glm::dvec3 starboard = level_or(sector.pose.attitude * glm::dvec3(1, 0, 0), {1, 0, 0});
  glm::dvec3 sum(0);
  double xx = 0, xy = 0, yy = 0;
  for (const SectorCell& cell : sector.cells)
    for (const glm::dvec3& way : cell.directions) {
      sum += way;
      xx += way.x * way.x, xy += way.x * way.y, yy += way.y * way.y;
    }
  constexpr double nearly_down = 0.1, nearly_round = 2;
  if (std::hypot(sum.x, sum.y) > nearly_down * glm::length(sum)) return level_or(sum, starboard);
  // The sector looks down. The section lies along the wider side of a fan.
  const double middle = (xx + yy) / 2, half = std::hypot((xx - yy) / 2, xy);
  if (middle + half < nearly_round * (middle - half))
    return level_or(sector.pose.attitude * glm::dvec3(0, 1, 0), {0, 1, 0});
  const double angle = std::atan2(2 * xy, xx - yy) / 2;
  const glm::dvec3 wide(std::cos(angle), std::sin(angle), 0);
  return glm::dot(wide, starboard) < 0 ? -wide : wide;
}

}  // namespace tubefoot
