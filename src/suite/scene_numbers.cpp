// SPDX-License-Identifier: GPL-3.0-or-later

// Describes a scene of the benchmark suite in numbers, for engines that do not read scene files. The
// numbers describe surfaces, water, beams, range samples, poses of the pings, and the measures that judge
// an engine.

#include "suite/scene_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "run/gradient_parameters.hpp"

namespace tubefoot {
namespace {

using Json = nlohmann::ordered_json;

double degrees(double angle_rad) { return angle_rad * 180 / std::numbers::pi; }

Json array(glm::dvec3 v) { return {v.x, v.y, v.z}; }

Json water_of(const Survey& survey) {
  const WaterDescription& water = survey.scene.description.water;
  const SensorPings& pings = survey.sensors.front();
  Json json{{"sound_speed_m_s", pings.sound_speed_m_s},
            {"absorption_db_per_km", 1000 * absorption_db_per_m(survey.scene, *pings.sensor)}};
  if (water.gradient_per_s)
    json["gradient"] = {{"surface_height_m", water.surface_height_m.value_or(0)},
                        {"surface_speed_m_s", water.sound_speed_m_s.value()},
                        {"per_s", *water.gradient_per_s},
                        {"constant_below_depth_m", water.profile_bottom_m.value()}};
  if (survey.scene.volume.any()) json["volume_scattering_per_m"] = survey.scene.volume.s_v_per_m.front();
  return json;
}

/// Returns position and axes, as keys of an object.
Json pose_json(const Pose& pose) {
  return {{"position_m", array(pose.position_m)},
          {"starboard", array(pose.attitude * glm::dvec3{1, 0, 0})},
          {"forward", array(pose.attitude * glm::dvec3{0, 1, 0})},
          {"up", array(pose.attitude * glm::dvec3{0, 0, 1})}};
}

/// Returns the pose of a moving object at each ping; empty for an object at rest.
Json motion_of(const Survey& survey, const std::string& name) {
  const Scene& scene = survey.scene;
  Json poses = Json::array();
  for (const MovingObject& object : scene.moving) {
    if (object.waves ||
        scene.description.objects.at(object.component - scene.description.terrains.size()).name != name)
      continue;
    for (const double time_s : survey.sensors.front().times_s)
      poses.push_back(pose_json(pose_of(object, scene.trajectories.at(object.trajectory), time_s)));
  }
  return poses;
}

/// Returns the borders of the beams. Inner borders are half-way between axes. An outermost border is as far
/// from its axis as the inner border of that beam.
Json borders_of(const std::vector<BeamAxis>& beams) {
  Json borders = Json::array();
  for (std::size_t k = 0; k + 1 < beams.size(); ++k) {
    const double a = beams[k].azimuth_rad, b = beams[k + 1].azimuth_rad;
    if (k == 0) borders.push_back(degrees(a - (b - a) / 2));
    borders.push_back(degrees((a + b) / 2));
    if (k + 2 == beams.size()) borders.push_back(degrees(b + (b - a) / 2));
  }
  return borders;
}

/// Returns the beams of a fan across the track by the corners of their pyramids, and its transmit sectors.
Json pyramids_of(const Sensor& sensor, const Survey& survey) {
  const SensorPings& pings = survey.sensors.front();
  Json axes = Json::array(), pyramids = Json::array(), sectors = Json::array();
  for (const BeamAxis& beam : sensor.beams()) {
    const glm::dvec3 axis = beam_direction(beam);
    axes.push_back(degrees(std::atan2(axis.x, -axis.z)));
    pyramids.push_back(Json::array());
  }
  for (std::size_t sector = 0; sector < sensor.transmissions(); ++sector) {
    const std::vector<std::uint32_t>& beams = sensor.beams_of_transmission(sector);
    const SteeredPose& first = pings.transmission_pose(0, sector);
    const TubeSet tubes = sensor.tubes(first, survey.scene.grid, sector);
    const glm::dmat3 to_sensor = glm::transpose(glm::mat3_cast(first.attitude));
    for (std::size_t tube = 0; tube < tubes.tubes.size(); ++tube) {
      Json corners = Json::array();
      for (const auto ray : tubes.tubes[tube]) {
        const GridPoint& r = tubes.rays[ray];
        corners.push_back(array(glm::normalize(to_sensor * glm::dvec3{r.x, r.y, r.z})));
      }
      pyramids.at(beams.at(sensor.beam_of_tube(sector)[tube])).push_back(corners);
    }
    Json poses = Json::array();
    for (std::size_t ping = 0; ping < pings.poses.size(); ++ping)
      poses.push_back(pose_json(pings.transmission_pose(ping, sector)));
    sectors.push_back({{"first_beam", beams.front()},
                       {"end_beam", beams.back() + 1},
                       {"delay_s", sensor.transmission_delay_s(sector)},
                       {"absorption_db_per_km", 1000 * absorption_db_per_m(survey.scene, sensor, sector)},
                       {"pings", poses}});
  }
  return {{"axes_deg", axes}, {"pyramids", pyramids}, {"sectors", sectors}};
}

Json beams_of(const Sensor& sensor, const Survey& survey) {
  Json axes = Json::array();
  if (sensor.is_across_track()) return pyramids_of(sensor, survey);
  for (const BeamAxis& beam : sensor.beams()) axes.push_back(degrees(beam.azimuth_rad));
  const double half_height_deg = degrees(sensor.beams().front().elevation_width_rad) / 2;
  Json json{{"axes_deg", axes},
            {"borders_deg", borders_of(sensor.beams())},
            {"lower_deg", -half_height_deg},
            {"upper_deg", half_height_deg}};
  if (const PatternDescription& receive = sensor.description().receive; receive.pattern != "none")
    json["receive"] = {{"pattern", receive.pattern},
                       {"aperture_m", receive.aperture_m.value()},
                       {"frequency_khz", sensor.frequency_khz()}};
  if (const std::string& shadow = sensor.description().shadow; shadow != "sharp") {
    json["shadow"] = shadow;
    json["frequency_khz"] = sensor.frequency_khz();
  }
  return json;
}

Json pings_of(const SensorPings& sensor) {
  Json pings = Json::array();
  for (std::size_t p = 0; p < sensor.poses.size(); ++p) {
    Json ping{{"time_s", sensor.times_s[p]}};
    ping.update(pose_json(sensor.poses[p]));
    if (!sensor.receiver_poses.empty()) ping["receiver_m"] = array(sensor.receiver_pose(p, 0).position_m);
    pings.push_back(ping);
  }
  return pings;
}

}  // namespace

Json scene_numbers(const Aspect& aspect, const SuiteScene& scene, const Survey& survey) {
  const SceneDescription& description = survey.scene.description;
  const SensorPings& sensor = survey.sensors.front();
  const RangeSamples& samples = sensor.sensor->samples();
  Json surfaces = Json::array();
  for (const Solid& solid : scene.solids) {
    const auto material =
        std::ranges::find(description.materials, solid.material, &MaterialDescription::name);
    const auto number = static_cast<std::size_t>(material - description.materials.begin());
    surfaces.push_back({{"name", solid.name},
                        {"obj", solid.name + ".obj"},
                        {"stl", solid.name + ".stl"},
                        {"facets", solid.facets.size()},
                        {"mu", survey.scene.material_mu.at(number)}});
    if (const Json motion = motion_of(survey, solid.name); !motion.empty()) surfaces.back()["pings"] = motion;
  }
  Json judged = Json::array();
  for (const Decider& decider : scene.deciders)
    judged.push_back({{"measure", decider.measure}, {"limit", decider.limit}});
  Json json{{"scene", aspect.name},
            {"tests", aspect.tests},
            {"title", scene.title},
            {"surfaces", surfaces},
            {"water", water_of(survey)}};
  if (description.sea_surface)
    json["sea_surface"] = {{"height_m", description.sea_surface->height_m},
                           {"loss_db", description.sea_surface->loss_db}};
  json["bounces"] = {{"most", description.paths.order}, {"scatterings", description.paths.scatterings}};
  json["beams"] = beams_of(*sensor.sensor, survey);
  json["samples"] = {{"first_m", samples.first_m}, {"step_m", samples.step_m}, {"count", samples.count}};
  json["pings"] = pings_of(sensor);
  json["shape"] = {sensor.poses.size(), sensor.sensor->beams().size(), samples.count};
  json["judged_by"] = judged;
  if (scene.later_from_m) json["later_from_m"] = *scene.later_from_m;
  if (scene.main_lobe_beams) json["main_lobe_beams"] = *scene.main_lobe_beams;
  if (scene.water_to_m) json["water_to_m"] = *scene.water_to_m;
  if (!scene.gradient.empty()) {
    Json parameters = Json::array();
    for (const GradientParameter& parameter :
         gradient_parameters(description, scene.gradient, survey.scene.water.get()))
      parameters.push_back({{"name", parameter.name}, {"units", parameter.units}});
    json["gradient"] = parameters;
  }
  return json;
}

}  // namespace tubefoot
