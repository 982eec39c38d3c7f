// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a scenario of HoloOcean: an agent with a sonar sensor for each sonar. It also writes the meshes of
// the scene for import into the engine.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "exchange/plain_number.hpp"
#include "exchange/writers/scene_writers.hpp"
#include "files/checked_file.hpp"
#include "files/json_text.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

using Json = nlohmann::ordered_json;
using Shape = ExchangedSonar::Shape;

const EngineAxes& holo_axes() { return axes_of(ExchangeFormat::holoocean); }

void set_place(Json& of, const Placement& theirs) {
  const glm::dvec3 p = theirs.position_m, rpy = roll_pitch_yaw(theirs.turn);
  const double largest_m = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  constexpr double right_angle_deg = 90;
  of["location"] = {plain(p.x, largest_m), plain(p.y, largest_m), plain(p.z, largest_m)};
  of["rotation"] = {plain(degrees(rpy.x), right_angle_deg), plain(degrees(rpy.y), right_angle_deg),
                    plain(degrees(rpy.z), right_angle_deg)};
}

std::string type_of(const ExchangedSonar& sonar) {
  if (sonar.shape == Shape::two_sides) return "SidescanSonar";
  if (sonar.looks_down) return sonar.azimuth_deg.size() == 1 ? "SinglebeamSonar" : "ProfilingSonar";
  return "ImagingSonar";
}

Json sensor_of(const ExchangedSonar& sonar) {
  const std::string type = type_of(sonar);
  Json configuration{{"RangeMin", sonar.range_min_m}, {"RangeMax", sonar.range_max_m}};
  const bool sides = sonar.shape == Shape::two_sides;
  configuration["RangeBins"] = sides ? 2 * sonar.samples : sonar.samples;
  if (type == "SinglebeamSonar") {
    configuration["OpeningAngle"] = sonar.vertical_deg;
  } else {
    const double shallowest = sonar.depression_deg - sonar.vertical_deg / 2;
    configuration["Azimuth"] = sides                           ? plain(2 * (90 - shallowest))
                               : sonar.shape == Shape::turning ? sonar.scan_deg
                                                               : sonar.horizontal_deg;
    configuration["Elevation"] = sides ? sonar.along_track_deg : sonar.vertical_deg;
    if (!sides) configuration["AzimuthBins"] = sonar.azimuth_deg.size();
  }
  configuration["InitOctreeRange"] = sonar.range_max_m;
  for (const char* noise : {"AddSigma", "MultSigma", "RangeSigma"}) configuration[noise] = 0;
  if (type == "ImagingSonar" || type == "ProfilingSonar") configuration["MultiPath"] = false;
  configuration["WaterSpeedSound"] = sonar.sound_speed_m_s;
  Json sensor{{"sensor_type", type}, {"sensor_name", sonar.name}};
  Placement ours = sides ? sonar.own : sonar.placement;
  if (sonar.shape == Shape::turning) {
    // The fan of HoloOcean is symmetric about its axis. For an even number of steps, its centre is half a
    // step off the axis of the sonar.
    ours = turned_to(ours, radians((sonar.azimuth_deg.front() + sonar.azimuth_deg.back()) / 2));
  }
  set_place(sensor, to_theirs(inverse(sonar.carrier) * ours, holo_axes().body, holo_axes().sonar));
  sensor["Hz"] = 1;
  sensor["configuration"] = configuration;
  return sensor;
}

std::vector<std::string> holoocean_notes(const ExchangedScene& scene) {
  std::vector<std::string> notes{
      "HoloOcean's worlds are made in the Unreal editor: import scene.gltf there in metres, and rotate it "
      "until y points north and z points up. Then package the world, and replace YOUR_WORLD in scenario.json "
      "with its name",
      "in HoloOcean's worlds x is east, y is north and z is up. HoloOcean's documentation calls these axes "
      "right-handed, but names the pitch axis 'right (y)', although y points left. Exported rotations are "
      "right-handed about x, y and z: test them with one tilted sonar first",
      "HoloOcean computes the echoes of octree cells (octree_min in scenario.json). Its materials.csv "
      "contains densities and sound speeds, so no scattering strengths are exported",
      "HoloOcean's documentation does not say which side has positive azimuths: test this with one object on "
      "one side first",
      "HoloOcean's documentation does not say whether objects nearer than RangeMin cast shadows: test this "
      "with one object nearer than RangeMin first"};
  for (const ExchangedSonar& sonar : scene.sonars) {
    if (sonar.shape == Shape::two_sides)
      notes.push_back(
          fmt::format("sonar '{}': RangeBins counts the bins of both sides; Azimuth spans both sides and the "
                      "gap between them; the frame of the sonar is its body, with x forward",
                      sonar.name));
    else if (sonar.shape == Shape::turning)
      notes.push_back(fmt::format(
          "sonar '{}' becomes a fixed fan, because no motor turns its beam in HoloOcean", sonar.name));
    else if (!sonar.even)
      notes.push_back(
          fmt::format("sonar '{}': its beams are not equiangular, but AzimuthBins are", sonar.name));
    if (sonar.shape == Shape::fan && sonar.looks_down)
      notes.push_back(
          fmt::format("sonar '{}' becomes a forward-looking sonar that is turned downwards", sonar.name));
  }
  return notes;
}

}  // namespace

WrittenScene write_holoocean_scene(const ExchangedScene& scene, const std::filesystem::path& folder) {
  const WrittenScene meshes = write_gltf_scene(scene, folder);
  Json agents = Json::array();
  for (std::size_t k = 0; k < scene.sonars.size(); ++k) {
    Json agent{{"agent_name", fmt::format("auv{}", k)}, {"agent_type", "HoveringAUV"}};
    agent["sensors"] = Json::array({sensor_of(scene.sonars[k])});
    agent["control_scheme"] = 0;
    set_place(agent, to_theirs(scene.sonars[k].carrier, holo_axes().world, holo_axes().body));
    agents.push_back(agent);
  }
  Json root{{"_comment", axes_words(ExchangeFormat::holoocean)},
            {"name", scene.title.empty() ? "scene" : scene.title},
            {"package_name", "Ocean"},
            {"world", "YOUR_WORLD"},
            {"main_agent", "auv0"},
            {"ticks_per_sec", 1},
            {"frames_per_sec", false},
            {"octree_min", 0.02},
            {"octree_max", 5.0},
            {"agents", agents}};
  write_file(folder / "scenario.json", std::string_view(text_of(root) + "\n"));
  WrittenScene written{{"scenario.json"}, holoocean_notes(scene)};
  written.files.insert(written.files.end(), meshes.files.begin(), meshes.files.end());
  written.notes.push_back(meshes.notes.front());
  return written;
}

}  // namespace tubefoot
