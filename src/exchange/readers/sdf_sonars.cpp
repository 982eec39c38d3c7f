// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the sonars of SDF: the plugins of DAVE and of uuv_simulator, and lidars with vertical rays. The fans
// are those that the source code of each plugin computes, which differ from the angles that the world states.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "exchange/readers/sdf_frames.hpp"
#include "exchange/readers/sdf_parts.hpp"
#include "files/shown.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

constexpr double default_distance_m = 60;  ///< <maxDistance> of all plugins of DAVE

/// Beams between the azimuths of the two outermost beams, and a height between two elevations.
struct SdfFan {
  double beams = 0;
  double low_deg = 0, high_deg = 0;     ///< azimuths, positive to port
  double below_deg = 0, above_deg = 0;  ///< elevations, positive upwards
  double near_m = 0, far_m = 0;
};

class SdfSonar {
 public:
  SdfSonar(WorldParts& parts, pugi::xml_node sensor, const Placement& placed)
      : parts_(parts), xml_(parts.xml()), node_(sensor), placed_(placed), name_(sdf_name_of(sensor)) {}

  void read() {
    for (const pugi::xml_node child : node_.children()) {
      const std::string_view name = child.name();
      if (child.type() == pugi::node_element && name != "pose" && name != "camera" && name != "ray" &&
          name != "lidar" && name != "gz:multibeam_sonar" && !is_sonar(child))
        parts_.without_effect(child);
    }
    if (const pugi::xml_node block = node_.child("gz:multibeam_sonar")) return rendered_rays(block);
    for (const pugi::xml_node plugin : node_.children("plugin"))
      if (is_sonar(plugin)) {
        if (const pugi::xml_node camera = node_.child("camera")) return raster(plugin, camera);
        if (const pugi::xml_node ray = scan_block()) return rays(plugin, ray);
      }
    const std::string_view type = node_.attribute("type").value();
    for (const char* lidar : {"ray", "gpu_ray", "lidar", "gpu_lidar"})
      if (type == lidar) return rays({}, scan_block());
    parts_.notice(node_, fmt::format("sensor '{}' is left out: tubefoot does not read sensors of type '{}'",
                                     name_, shown_line(type)));
  }

 private:
  static std::string text(double value) { return fmt::format("{}", value); }
  static bool is_image_sonar(pugi::xml_node plugin) {
    return std::string_view(plugin.attribute("filename").value()).find("image_sonar") !=
           std::string_view::npos;
  }
  static bool is_sonar(pugi::xml_node node) {
    if (std::string_view(node.name()) != "plugin") return false;
    return is_image_sonar(node) ||
           std::string_view(node.attribute("filename").value()).find("multibeam_sonar") !=
               std::string_view::npos;
  }
  pugi::xml_node scan_block() const { return node_.child("ray") ? node_.child("ray") : node_.child("lidar"); }

  /// Counts the parameters of a plugin that a scene of tubefoot does not have.
  void count_others(pugi::xml_node settings) {
    constexpr std::array read{"sonarFreq", "bandwidth", "soundSpeed", "maxDistance", "verticalFOV"};
    constexpr std::array acoustic{"sourceLevel",
                                  "sensorGain",
                                  "constantReflectivity",
                                  "customSDFTagReflectivity",
                                  "customSDFTagDatabaseFile",
                                  "reflectivityDatabaseFile",
                                  "artificialVehicleVibration"};
    for (const pugi::xml_node child : settings.children()) {
      const std::string_view name = child.name();
      if (child.type() != pugi::node_element || std::ranges::find(read, name) != read.end()) continue;
      if (std::ranges::find(acoustic, name) != acoustic.end())
        parts_.pass_over(child);
      else if (name != "ray" && name != "spec")
        parts_.without_effect(child);
    }
  }

  /// DAVE's plugin for Gazebo (IOES-Lab/dave, gazebo/dave_gz_multibeam_sonar, MultibeamSonarSensor.cc). Each
  /// direction is a cone whose aperture is the whole vertical angle. The rendered rays fill the box around
  /// all cones, symmetric about the axis. The height is therefore about twice the stated one. An even
  /// number of beams becomes odd, and the outermost rays lie at the stated azimuths.
  void rendered_rays(pugi::xml_node block) {
    const pugi::xml_node ray = block.child("ray"), spec = block.child("spec");
    const pugi::xml_node across = ray.child("scan").child("horizontal"),
                         up = ray.child("scan").child("vertical");
    const bool in_degrees = sdf_true(ray.attribute("degrees").value());
    const double unit = in_degrees ? 1 : 180 / std::numbers::pi;
    const auto angle = [&](pugi::xml_node node, const char* child, double otherwise_rad) {
      return node.child(child) ? unit * xml_.child_number(node, child, 0) : degrees(otherwise_rad);
    };
    SdfFan fan;
    fan.beams = xml_.child_number(across, "beams", 256);
    fan.beams += std::fmod(fan.beams, 2) == 0 ? 1 : 0;
    fan.low_deg = angle(across, "min_angle", -std::numbers::pi / 4);
    fan.high_deg = angle(across, "max_angle", std::numbers::pi / 4);
    const double below = angle(up, "min_angle", -std::numbers::pi / 8),
                 above = angle(up, "max_angle", std::numbers::pi / 8), aperture = above - below;
    const double rays = std::max(1.0, xml_.child_number(up, "rays", 3)), last = above - aperture / rays;
    fan.above_deg = std::max(std::abs(below), std::abs(last)) + aperture / 2;
    fan.below_deg = -fan.above_deg;
    fan.near_m = xml_.child_number(ray.child("range"), "min", 0.1);
    fan.far_m = std::min(xml_.child_number(ray.child("range"), "max", 5),
                         xml_.child_number(spec, "maxDistance", default_distance_m));
    if (in_degrees)
      parts_.notice(node_, fmt::format("sonar '{}' states its angles in degrees: its plugin renders the "
                                       "horizontal ones as if they were in radians",
                                       name_));
    say_height(fan, aperture, "twice the stated angle, symmetric about the axis");
    count_others(spec);
    if (above > below)
      add(fan, spec);
    else
      flat();
  }

  /// The ray version of Field-Robotics-Lab/nps_uw_multibeam_sonar (gazebo_multibeam_sonar_ray_based.cpp,
  /// sonar_calculation_cuda.cu), and lidars. All rays between the stated angles have the same weight;
  /// <verticalFOV> has no effect.
  void rays(pugi::xml_node plugin, pugi::xml_node ray) {
    const pugi::xml_node across = ray.child("scan").child("horizontal"),
                         up = ray.child("scan").child("vertical");
    SdfFan fan;
    fan.beams = xml_.child_number(across, across.child("beams") ? "beams" : "samples", 640);
    const double resolution = xml_.child_number(across, "resolution", 1);
    if (resolution > 0) fan.beams = std::round(fan.beams * resolution);
    fan.low_deg = degrees(xml_.child_number(across, "min_angle", 0));
    fan.high_deg = degrees(xml_.child_number(across, "max_angle", 0));
    fan.below_deg = degrees(xml_.child_number(up, "min_angle", 0));
    fan.above_deg = degrees(xml_.child_number(up, "max_angle", 0));
    fan.near_m = xml_.child_number(ray.child("range"), "min", 0);
    fan.far_m = xml_.child_number(ray.child("range"), "max", 0);
    if (plugin) fan.far_m = std::min(fan.far_m, xml_.child_number(plugin, "maxDistance", default_distance_m));
    if (ray.child("noise")) parts_.pass_over(ray.child("noise"));
    if (!(fan.above_deg > fan.below_deg)) return flat();
    if (plugin)
      say_height(fan, xml_.child_number(plugin, "verticalFOV", 10), "the angle between its outermost rays");
    else
      parts_.notice(node_, fmt::format("'{}' is a lidar: it becomes a sonar with the same fan", name_));
    count_others(plugin);
    add(fan, plugin);
  }

  /// The raster version of nps_uw_multibeam_sonar (gazebo_multibeam_sonar_raster_based.cpp and
  /// sonar_calculation_cuda.cu), and the image sonar of uuv_simulator (gazebo_ros_image_sonar.cpp). The
  /// columns of a depth camera are equidistant beams, and all of its rows have the same weight. The height
  /// of the fan therefore follows from the shape of the image, and <verticalFOV> has no effect.
  void raster(pugi::xml_node plugin, pugi::xml_node camera) {
    constexpr double image_sonar_distance_m = 17, image_sonar_bins = 400;  // constants of that plugin
    const double width = xml_.child_number(camera.child("image"), "width", 320),
                 height = xml_.child_number(camera.child("image"), "height", 240),
                 across = xml_.child_number(camera, "horizontal_fov", 1.047);
    SdfFan fan;
    fan.beams = width;
    fan.high_deg = degrees(across) / 2;
    fan.low_deg = -fan.high_deg;
    fan.above_deg = width > 0 ? degrees(std::atan(std::tan(across / 2) * height / width)) : 0;
    fan.below_deg = -fan.above_deg;
    fan.near_m = xml_.child_number(camera.child("clip"), "near", 0.1);
    const bool image_sonar = is_image_sonar(plugin);
    fan.far_m = std::min(
        xml_.child_number(camera.child("clip"), "far", 100),
        image_sonar ? image_sonar_distance_m : xml_.child_number(plugin, "maxDistance", default_distance_m));
    if (!(fan.above_deg > 0)) return flat();
    say_height(fan, image_sonar ? 0 : xml_.child_number(plugin, "verticalFOV", 10),
               "that of its camera image");
    count_others(plugin);
    const double samples = std::round(image_sonar_bins * (fan.far_m - fan.near_m) / image_sonar_distance_m);
    add(fan, plugin, true, image_sonar ? std::optional(std::max(1.0, samples)) : std::nullopt);
  }

  void flat() {
    parts_.notice(node_, fmt::format("sensor '{}' is left out: its rays lie in one plane, but the beams of a "
                                     "sonar need a height",
                                     name_));
  }

  /// Reports the height of a fan if it differs from the one that the world states.
  void say_height(const SdfFan& fan, double stated_deg, const char* why) {
    const double height_deg = fan.above_deg - fan.below_deg;
    if (stated_deg > 0 && std::abs(height_deg - stated_deg) > 0.01)
      parts_.notice(node_, fmt::format("sonar '{}': the world states a height of {:.4g} degrees, but its "
                                       "plugin computes {:.4g} degrees, {}",
                                       name_, stated_deg, height_deg, why));
  }

  /// Returns the number of samples. A bandwidth B resolves c / (2 B).
  double samples_of(pugi::xml_node settings, double length_m) {
    const double bandwidth = xml_.child_number(settings, "bandwidth", 0),
                 speed = xml_.child_number(settings, "soundSpeed", 1500);
    constexpr double usual = 512, most = 65536;
    double samples = bandwidth > 0 && speed > 0 ? std::round(length_m * 2 * bandwidth / speed) : usual;
    samples = std::clamp(samples, 1.0, most);
    parts_.notice(
        node_, fmt::format("sensor '{}' does not state its number of range samples: {} samples are assumed{}",
                           name_, samples, bandwidth > 0 ? " from its bandwidth" : ""));
    return samples;
  }

  void add(const SdfFan& fan, pugi::xml_node settings, bool equidistant = false,
           std::optional<double> samples = {}) {
    // Outermost beams are centred on the stated azimuths, except those of images, which end there.
    const double width_deg = fan.high_deg - fan.low_deg,
                 horizontal_deg =
                     equidistant || fan.beams < 2 ? width_deg : width_deg * fan.beams / (fan.beams - 1);
    ImportedSensor sensor;
    sensor.name = name_;
    sensor.keys = {{"kind", "\"imaging\""},
                   {"beams", text(fan.beams)},
                   {"horizontal_deg", text(horizontal_deg)},
                   {"vertical_deg", text(fan.above_deg - fan.below_deg)}};
    if (equidistant) sensor.keys.emplace_back("spacing", "\"distance\"");
    sensor.keys.emplace_back("range_min_m", text(fan.near_m));
    sensor.keys.emplace_back("range_max_m", text(fan.far_m));
    if (!samples) samples = samples_of(settings, fan.far_m - fan.near_m);
    sensor.keys.emplace_back("samples", text(*samples));
    if (const double hertz = xml_.child_number(settings, "sonarFreq", 0); hertz > 0)
      sensor.keys.emplace_back("frequency_khz", text(hertz / 1000));
    if (settings.child("soundSpeed")) parts_.sound_speed(node_, xml_.child_number(settings, "soundSpeed", 0));
    // Rotates to the centre of the fan: about z to port, then about y downwards.
    const glm::dmat3 middle = turn_of(
        {0, -radians((fan.below_deg + fan.above_deg) / 2), radians((fan.low_deg + fan.high_deg) / 2)});
    parts_.add_sensor(node_, std::move(sensor), {placed_.position_m, placed_.turn * middle});
  }

  WorldParts& parts_;
  const XmlInput& xml_;
  pugi::xml_node node_;
  Placement placed_;
  std::string name_;
};

}  // namespace

void read_sdf_sensor(WorldParts& parts, pugi::xml_node sensor, const Placement& link,
                     const Placement& placed) {
  if (parts.add_own_sonar(sensor, link, parts.axes().sonar)) return;
  SdfSonar(parts, sensor, placed).read();
}

}  // namespace tubefoot
