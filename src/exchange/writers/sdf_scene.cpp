// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a scene as an SDF world: static models of the meshes, and one model per sonar with the multibeam
// sensor of DAVE for Gazebo. Properties that SDF lacks are in elements of the tubefoot namespace.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "exchange/obj_mesh.hpp"
#include "exchange/writers/scene_writers.hpp"
#include "exchange/writers/xml_words.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

/// DAVE's plugin (MultibeamSonarSensor.cc) passes <range><min> to SetNearClipPlane().
constexpr double dave_near_plane_m = 0.02;

const EngineAxes& sdf_axes() { return axes_of(ExchangeFormat::sdf); }

std::string pose_text(const Placement& theirs) {
  return fmt::format("{} {}", numbers_text(theirs.position_m), rpy_text(theirs));
}

void add_geometry(pugi::xml_node parent, const std::string& mesh) {
  add(add(add(parent, "geometry"), "mesh"), "uri", mesh);
}

void add_sdf_piece(pugi::xml_node world, const ExchangedScene& scene, const ExchangedPiece& piece,
                   const std::string& mesh) {
  const ExchangedMaterial& material = scene.materials[piece.material];
  const pugi::xml_node model = set(add(world, "model"), "name", piece.file_stem);
  add(model, "static", "true");
  const pugi::xml_node link = set(add(model, "link"), "name", std::string("link"));
  add_geometry(set(add(link, "collision"), "name", std::string("collision")), mesh);
  const pugi::xml_node visual = set(add(link, "visual"), "name", std::string("visual"));
  add_geometry(visual, mesh);
  const pugi::xml_node look = add(visual, "material");
  const double grey = grey_of(material);
  for (const char* light : {"ambient", "diffuse"}) add(look, light, fmt::format("{0} {0} {0} 1", grey));
  add(look, "specular", "0 0 0 1");
  set(add(visual, "tubefoot:material"), "name", material.name);
}

/// A fan of beams about the x axis of the sensor. Its angles increase to port, as rotations about z do.
struct Fan {
  std::string name;
  Placement placed;  ///< in the link, in the axes of SDF
  std::size_t beams = 1;
  double lowest_rad = 0, highest_rad = 0, half_height_rad = 0;  ///< borders
};

/// Axes that DAVE's plugin renders (MultibeamSonarSensor.cc): the outermost axes lie at the stated angles,
/// and an even number becomes odd. One axis has no width, so that a single beam needs a neighbour on either
/// side.
struct DaveAxes {
  std::size_t count;
  double first_rad, last_rad;
};
DaveAxes dave_axes(const Fan& fan) {
  const double width_rad = (fan.highest_rad - fan.lowest_rad) / static_cast<double>(fan.beams);
  if (fan.beams == 1) return {3, fan.lowest_rad - width_rad / 2, fan.highest_rad + width_rad / 2};
  if (fan.beams % 2 == 0)
    return {fan.beams + 1, fan.lowest_rad + width_rad / 2, fan.highest_rad + width_rad / 2};
  return {fan.beams, fan.lowest_rad + width_rad / 2, fan.highest_rad - width_rad / 2};
}

void add_fan(pugi::xml_node link, const ExchangedSonar& sonar, const Fan& fan, bool first,
             const Placement& own) {
  const pugi::xml_node sensor = set(add(link, "sensor"), "name", fan.name);
  set(sensor, "type", std::string("custom"));
  set(sensor, "gz:type", std::string("multibeam_sonar"));
  add(sensor, "pose", pose_text(fan.placed));
  add(sensor, "always_on", "true");
  add(sensor, "update_rate", 1.0);
  add(sensor, "topic", "/" + fan.name);
  const pugi::xml_node block = add(sensor, "gz:multibeam_sonar");
  const pugi::xml_node ray = set(add(block, "ray"), "degrees", std::string("false"));
  const pugi::xml_node scan = add(ray, "scan");
  const pugi::xml_node across = add(scan, "horizontal");
  const DaveAxes axes = dave_axes(fan);
  add(across, "beams", static_cast<double>(axes.count));
  add(across, "min_angle", axes.first_rad);
  add(across, "max_angle", axes.last_rad);
  // As many rays as the width of the beams requires. The beams of tubefoot are solid and have no number of
  // rays.
  const double step_rad = (fan.highest_rad - fan.lowest_rad) / static_cast<double>(fan.beams);
  constexpr double most_rays = 1000, least_rays = 10;
  const pugi::xml_node up = add(scan, "vertical");
  add(up, "rays", std::round(std::clamp(2 * fan.half_height_rad / step_rad, least_rays, most_rays)));
  add_comment(up, "The plugin renders twice the stated height.");
  add(up, "min_angle", -fan.half_height_rad / 2);
  add(up, "max_angle", fan.half_height_rad / 2);
  const pugi::xml_node range = add(ray, "range");
  add_comment(range, fmt::format("min is the near clipping plane of the plugin. The minimum range of the "
                                 "sonar is {} m: remove nearer echoes from the picture.",
                                 sonar.range_min_m));
  add(range, "min", engine_ranges(sonar, dave_near_plane_m, false).range_min_m);
  add(range, "max", sonar.range_max_m);
  const pugi::xml_node spec = add(block, "spec");
  add(spec, "sonarFreq", 1000 * sonar.frequency_khz);
  // A bandwidth B resolves c / (2 B), which is one sample of tubefoot.
  const double sample_m = (sonar.range_max_m - sonar.range_min_m) / sonar.samples;
  add(spec, "bandwidth", sonar.sound_speed_m_s / (2 * sample_m));
  add(spec, "soundSpeed", sonar.sound_speed_m_s);
  add(spec, "maxDistance", sonar.range_max_m);
  add(spec, "raySkips", 1.0);  // all rays; the default of the plugin is 10
  if (first)
    add_own_sonar(sensor, sonar, own);
  else
    set(add(sensor, "tubefoot:part_of"), "name", sonar.name);
}

void add_sonar(pugi::xml_node world, const ExchangedSonar& sonar, std::size_t number) {
  const Axes& body = sdf_axes().body;
  const pugi::xml_node model = set(add(world, "model"), "name", fmt::format("carrier_of_sonar_{}", number));
  add(model, "static", "true");
  add(model, "pose", pose_text(to_theirs(sonar.carrier, sdf_axes().world, body)));
  const pugi::xml_node link = set(add(model, "link"), "name", std::string("link"));
  // Relative to the carrier, both in the axes of bodies.
  const auto placed = [&](const Placement& ours) {
    return to_theirs(inverse(sonar.carrier) * ours, body, sdf_axes().sonar);
  };
  const Placement own = placed(sonar.own);
  Fan fan{sonar.name, placed(sonar.placement), sonar.azimuth_deg.size()};
  if (sonar.shape == ExchangedSonar::Shape::two_sides) {
    fan.beams = 1;
    fan.highest_rad = radians(sonar.along_track_deg) / 2;
    fan.lowest_rad = -fan.highest_rad;
    fan.half_height_rad = radians(sonar.vertical_deg) / 2;
    for (const bool port : {true, false}) {
      // In the axes of bodies, with x forward: yaw to the side, then pitch down.
      const glm::dmat3 turn = turn_of({0, radians(sonar.depression_deg), radians(port ? 90 : -90)});
      fan.name = sonar.name + (port ? "_port" : "_starboard");
      fan.placed = {own.position_m, own.turn * turn};
      add_fan(link, sonar, fan, port, own);
    }
    return;
  }
  fan.highest_rad = radians(sonar.horizontal_deg) / 2;
  fan.lowest_rad = -fan.highest_rad;
  if (sonar.shape == ExchangedSonar::Shape::turning) {
    // The range of steps plus half a step on either side. An even number of steps is not symmetric about
    // the forward direction.
    fan.lowest_rad = -radians(sonar.azimuth_deg.back() + sonar.step_deg / 2);
    fan.highest_rad = -radians(sonar.azimuth_deg.front() - sonar.step_deg / 2);
  } else if (!sonar.even) {
    const double left = -sonar.azimuth_deg.front(), right = sonar.azimuth_deg.back();
    const double spare = sonar.horizontal_deg - (left + right);
    fan.lowest_rad = -radians(right + spare / 2);
    fan.highest_rad = radians(left + spare / 2);
  }
  fan.half_height_rad = radians(sonar.vertical_deg) / 2;
  add_fan(link, sonar, fan, true, own);
}

/// Adds the systems of DAVE's own sonar world (dave_multibeam_sonar.world). Without the first two, the sonar
/// is silent. A world that names systems does not get the default ones, which are the others.
void add_systems(pugi::xml_node world) {
  const auto add_system = [&](const char* file, const char* name) {
    const pugi::xml_node plugin = set(add(world, "plugin"), "filename", std::string(file));
    return set(plugin, "name", std::string(name));
  };
  add(add_system("gz-sim-sensors-system", "gz::sim::systems::Sensors"), "render_engine", "ogre2");
  add_system("multibeam_sonar_system", "custom::MultibeamSonarSystem");
  add_system("gz-sim-physics-system", "gz::sim::systems::Physics");
  add_system("gz-sim-user-commands-system", "gz::sim::systems::UserCommands");
  add_system("gz-sim-scene-broadcaster-system", "gz::sim::systems::SceneBroadcaster");
}

std::vector<std::string> sdf_notes(const ExchangedScene& scene) {
  std::vector<std::string> notes{
      "sonars are sensors of type \"custom\" with gz:type=\"multibeam_sonar\". DAVE's plugin for Gazebo "
      "reads them, and other programs ignore them. Elements tubefoot:... hold the exact values for "
      "'tubefoot import-scene'",
      "the plugin's angles are positive to port. The beams of its image are in the reverse order of its "
      "list of directions: test this with one object on one side first",
      "the plugin uses rays instead of beams: the vertical spacing of 'rays' equals the width of the "
      "beams, and the bandwidth resolves one range sample. The outermost rays lie at the stated "
      "azimuths, and the rays fill twice the stated height. The exported angles compensate for both",
      "the world loads the systems 'gz-sim-sensors-system' (with the render engine 'ogre2') and "
      "'multibeam_sonar_system' (class 'custom::MultibeamSonarSystem'), without which DAVE's sonar is "
      "silent. If you add the sonar to another world, add both plugins to that world",
      "'min' of <range> is the near clipping plane of the plugin, in front of which nothing casts a "
      "shadow. The minimum range of each sonar is listed above: remove nearer echoes from the picture"};
  for (const ExchangedSonar& sonar : scene.sonars) {
    const bool two_sides = sonar.shape == ExchangedSonar::Shape::two_sides;
    if (two_sides || sonar.azimuth_deg.size() == 1)
      notes.push_back(fmt::format(
          "sonar '{}': the plugin needs three beams instead of one: use the middle one only", sonar.name));
    else if (sonar.azimuth_deg.size() % 2 == 0)
      notes.push_back(
          fmt::format("sonar '{}': the plugin renders {} beams instead of {}: remove the port-most one",
                      sonar.name, sonar.azimuth_deg.size() + 1, sonar.azimuth_deg.size()));
    if (two_sides)
      notes.push_back(
          fmt::format("sonar '{}' becomes two sensors with one beam each, '{}_port' and '{}_starboard'",
                      sonar.name, sonar.name, sonar.name));
    else if (sonar.shape == ExchangedSonar::Shape::turning)
      notes.push_back(
          fmt::format("sonar '{}' becomes a fixed fan, because no motor turns its beam in SDF", sonar.name));
    else if (!sonar.even)
      notes.push_back(
          fmt::format("sonar '{}': its beams are not equiangular, but those of SDF are", sonar.name));
  }
  return notes;
}

}  // namespace

WrittenScene write_sdf_scene(const ExchangedScene& scene, const std::filesystem::path& folder) {
  const std::vector<std::string> meshes = write_piece_meshes(ExchangeFormat::sdf, scene, folder);
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  set(declaration, "version", std::string("1.0"));
  add_comment(document, axes_words(ExchangeFormat::sdf));
  const pugi::xml_node sdf = set(add(document, "sdf"), "version", std::string("1.7"));
  set(sdf, "xmlns:tubefoot", std::string(own_namespace));
  set(sdf, "xmlns:gz", std::string("http://gazebosim.org/schema"));
  const pugi::xml_node world = set(add(sdf, "world"), "name", std::string("scene"));
  add_systems(world);
  add_own_scene(world, scene);
  const pugi::xml_node sun = set(add(world, "light"), "name", std::string("sun"));
  set(sun, "type", std::string("directional"));
  add(sun, "direction", "-0.5 0.1 -0.9");
  for (std::size_t k = 0; k < scene.pieces.size(); ++k)
    add_sdf_piece(world, scene, scene.pieces[k], meshes[k]);
  for (std::size_t k = 0; k < scene.sonars.size(); ++k) add_sonar(world, scene.sonars[k], k);
  write_xml(document, folder / "scene.sdf");
  WrittenScene written{{"scene.sdf"}, sdf_notes(scene)};
  written.files.insert(written.files.end(), meshes.begin(), meshes.end());
  return written;
}

}  // namespace tubefoot
