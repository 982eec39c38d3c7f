// SPDX-License-Identifier: GPL-3.0-or-later
// Reads Stonefish scenarios: bodies with their meshes and primitives, robots, materials, and the sonars fls,
// msis and sss. Source of the elements: ScenarioParser.cpp of Stonefish 1.6.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "exchange/readers/world_parts.hpp"
#include "exchange/stonefish_beams.hpp"
#include "exchange/toml_text.hpp"
#include "files/shown.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

class StonefishReader {
 public:
  explicit StonefishReader(WorldParts& parts) : parts_(parts), xml_(parts.xml()) {}

  void read() {
    const pugi::xml_node root = xml_.root();
    parts_.read_own_scene(root);
    for (const pugi::xml_node node : root.children()) {
      if (node.type() != pugi::node_element) continue;
      const std::string_view name = node.name();
      if (name == "static" || name == "dynamic" || name == "animated")
        body(node);
      else if (name == "robot")
        robot(node);
      else if (name == "sensor")
        sensor(node, transform(node.child("world_transform")), {});
      else if (name == "include")
        parts_.notice(node,
                      fmt::format("<include> of '{}' is left out: replace it by the contents of that file",
                                  shown_line(node.attribute("file").value())));
      else if (name != "environment" && name != "materials" && name != "looks" && name != "tubefoot:scene")
        parts_.pass_over(node);
    }
  }

 private:
  static std::string name_of(pugi::xml_node node) { return shown_line(node.attribute("name").value()); }

  Placement transform(pugi::xml_node node) const {
    if (!node) return {};
    const std::vector<double> p = xml_.numbers(node, node.attribute("xyz").as_string("0 0 0"), 3, "xyz"),
                              r = xml_.numbers(node, node.attribute("rpy").as_string("0 0 0"), 3, "rpy");
    return {{p[0], p[1], p[2]}, turn_of({r[0], r[1], r[2]})};
  }

  double needed(pugi::xml_node node, pugi::xml_node parent, const char* attribute) const {
    if (!node.attribute(attribute))
      xml_.fail(node ? node : parent,
                fmt::format("'{}' has no attribute {}=\"...\"", name_of(parent), attribute));
    return xml_.attribute_number(node, attribute, 0);
  }

  void body(pugi::xml_node node) {
    const std::string_view kind = node.name();
    Placement placed = transform(node.child("world_transform"));
    if (kind == "animated") {
      const std::optional<Placement> start = first_place(node);
      if (!start) return;
      placed = *start;
    } else if (kind == "dynamic") {
      parts_.notice(
          node, fmt::format("'{}' moves in Stonefish: here it stays at its initial position", name_of(node)));
    }
    shape(node, placed);
    for (const pugi::xml_node inner : node.children()) {
      const std::string_view name = inner.name();
      if (name == "sensor")
        sensor(inner, placed, inner.child("origin"));
      else if (name == "light" || name == "comm")
        parts_.pass_over(inner);
    }
  }

  /// Returns the placement of an animated body at its earliest key point.
  std::optional<Placement> first_place(pugi::xml_node node) {
    const pugi::xml_node trajectory = node.child("trajectory");
    pugi::xml_node first;
    double first_s = 0;
    for (const pugi::xml_node key : trajectory.children("keypoint")) {
      const double time_s = xml_.attribute_number(key, "time", 0);
      // Stonefish ignores times below 0. A later key point at the same time replaces the
      // other.
      if (time_s < 0 || (first && time_s > first_s)) continue;
      first = key;
      first_s = time_s;
    }
    if (!first) {
      parts_.notice(node,
                    fmt::format("'{}' is left out with its sensors: it is animated, but its <trajectory> "
                                "has no <keypoint>",
                                name_of(node)));
      return {};
    }
    parts_.notice(node, fmt::format("'{}' moves along its <trajectory> in Stonefish: here it stays at its "
                                    "first key point, at {} s",
                                    name_of(node), first_s));
    return transform(first);
  }

  void shape(pugi::xml_node node, Placement placed) {
    ImportedObject object;
    object.name = name_of(node);
    const std::string_view type = node.attribute("type").value();
    const pugi::xml_node size = node.child("dimensions");
    object.shape = type;
    if (type == "empty") return;  // an animated frame for sensors
    if (type == "compound") return compound(node, placed);
    if (type == "model") {
      const pugi::xml_node seen = node.child("visual") ? node.child("visual") : node.child("physical");
      const pugi::xml_node mesh = seen.child("mesh");
      object.shape = "mesh";
      object.mesh = parts_.mesh(mesh ? mesh : node, mesh.attribute("filename").value());
      if (!object.mesh) return;
      const double scale = xml_.attribute_number(mesh, "scale", 1);
      object.scale = {scale, scale, scale};
      placed = placed * origin_of(seen, node);
    } else if (type == "box") {
      const std::vector<double> v =
          xml_.numbers(size ? size : node, size.attribute("xyz").value(), 3, "dimensions xyz");
      object.keys = {{"size_m", fmt::format("[{}, {}, {}]", v[0], v[1], v[2])}};
    } else if (type == "sphere") {
      object.keys = {{"radius_m", fmt::format("{}", needed(size, node, "radius"))}};
    } else if (type == "cylinder") {
      object.keys = {{"radius_m", fmt::format("{}", needed(size, node, "radius"))},
                     {"height_m", fmt::format("{}", needed(size, node, "height"))}};
    } else if (type == "plane") {
      constexpr double side_m = 10000;  // side of the plane that Stonefish draws
      object.shape = "mesh";
      object.mesh = parts_.mesh("plane", plane_mesh(side_m, side_m));
      parts_.notice(node, fmt::format("plane '{}' is infinite in Stonefish: here it is {} m wide",
                                      object.name, side_m));
    } else {
      return parts_.notice(node, fmt::format("'{}' is left out: tubefoot does not read shapes of type \"{}\"",
                                             object.name, shown_line(type)));
    }
    if (type != "model") placed = placed * origin_of(node, node);
    object.material = parts_.material(node.child("material").attribute("name").value());
    parts_.add_object(node, std::move(object), placed);
  }

  /// Returns the placement of the shape in its body. Stonefish draws animated bodies without it
  /// (AnimatedEntity.cpp).
  Placement origin_of(pugi::xml_node shape, pugi::xml_node body) {
    const Placement origin = transform(shape.child("origin"));
    if (std::string_view(body.name()) != "animated") return origin;
    if (origin.position_m != glm::dvec3(0) || origin.turn != glm::dmat3(1))
      parts_.notice(body,
                    fmt::format("the <origin> of '{}' is ignored, because Stonefish draws animated bodies "
                                "without it",
                                name_of(body)));
    return {};
  }

  /// Reads the parts on the outside of a compound body. Stonefish does not draw the others.
  void compound(pugi::xml_node node, const Placement& placed) {
    for (const pugi::xml_node part : node.children()) {
      const bool drawn =
          std::string_view(part.name()) == "external_part" ||
          (std::string_view(part.name()) == "internal_part" && part.attribute("always_visible").as_bool());
      if (drawn)
        shape(part, placed * transform(part.child("compound_transform")));
      else if (std::string_view(part.name()) == "internal_part")
        parts_.pass_over(part);
    }
  }

  void robot(pugi::xml_node node) {
    const Placement placed = transform(node.child("world_transform"));
    const std::string base = node.child("base_link").attribute("name").value();
    parts_.notice(
        node,
        fmt::format("robot '{}': its body is left out; its sonars are at the initial position of its base",
                    name_of(node)));
    for (const pugi::xml_node inner : node.children("sensor")) {
      const std::string link = inner.child("link").attribute("name").value();
      if (link.empty() || link == base)
        sensor(inner, placed, inner.child("origin"));
      else
        parts_.notice(inner,
                      fmt::format("sensor '{}' is left out: it is mounted on '{}', which is moved by joints",
                                  name_of(inner), shown_line(link)));
    }
  }

  void fan(pugi::xml_node node, ImportedSensor& sonar, double beams, double width_deg) {
    constexpr double most_beams = 4096;
    if (!(beams >= 1 && beams <= most_beams && beams == std::floor(beams)))
      xml_.fail(node.child("specs"), fmt::format("beams of '{}' is {}: expected a whole number from 1 to {}",
                                                 sonar.name, beams, most_beams));
    const int count = even(node, "beams", beams);
    const std::vector<double> angles = stonefish_beam_angles_deg(count, width_deg);
    if (angles.empty()) {
      sonar.keys.emplace_back("beams", fmt::format("{}", count));
      sonar.keys.emplace_back("horizontal_deg", fmt::format("{}", width_deg));
      parts_.notice(node,
                    fmt::format("sonar '{}': Stonefish cannot divide {} beams into {} views of at most 20 "
                                "degrees; equiangular beams are assumed",
                                sonar.name, count, stonefish_views(width_deg)));
      return;
    }
    sonar.keys.emplace_back("beam_angles_deg", toml_list(angles));
    parts_.notice(node, fmt::format("sonar '{}': its beams are equidistant in each of {} views, as in an FLS",
                                    sonar.name, stonefish_views(width_deg)));
  }

  /// Returns a number of beams or bins. Stonefish rounds odd ones up (Camera.cpp).
  int even(pugi::xml_node node, const char* what, double count) {
    constexpr double most = 1e6;
    const double whole = std::clamp(std::floor(count), 1.0, most), rounded = whole + std::fmod(whole, 2);
    if (rounded != whole)
      parts_.notice(node, fmt::format("sonar '{}' has {} {}, because Stonefish rounds odd numbers up",
                                      name_of(node), rounded, what));
    return static_cast<int>(rounded);
  }

  void sensor(pugi::xml_node node, const Placement& frame, pugi::xml_node origin) {
    // The placement is relative to the axes of the world: add_own_sonar() of the writer writes it so.
    if (parts_.add_own_sonar(node, {}, parts_.axes().sonar)) return;
    const Placement placed = frame * transform(origin);
    const std::string_view type = node.attribute("type").value();
    const pugi::xml_node specs = node.child("specs"), settings = node.child("settings");
    const auto number = [](double value) { return fmt::format("{}", value); };
    const auto spec = [&](const char* name) { return needed(specs, node, name); };
    ImportedSensor sonar;
    sonar.name = name_of(node);
    const auto add = [&](const char* key, const std::string& value) { sonar.keys.emplace_back(key, value); };
    bool looks_down = false;
    Placement at = placed;
    if (type == "fls") {
      add("kind", "\"imaging\"");
      fan(node, sonar, spec("beams"), spec("horizontal_fov"));
      add("vertical_deg", number(spec("vertical_fov")));
      add("samples", number(even(node, "bins", spec("bins"))));
    } else if (type == "msis") {
      const double low = xml_.attribute_number(settings, "rotation_min", -180),
                   high = xml_.attribute_number(settings, "rotation_max", 180);
      add("kind", "\"scanning\"");
      add("scan_deg", number(high - low));
      add("step_deg", number(spec("step")));
      add("beam_horizontal_deg", number(spec("horizontal_beam_width")));
      add("beam_vertical_deg", number(spec("vertical_beam_width")));
      add("samples", number(even(node, "bins", spec("bins"))));
      // The sonar rotates to starboard, which is about y, downwards.
      at.turn = placed.turn * turn_of({0, radians((low + high) / 2), 0});
    } else if (type == "sss") {
      const double tilt = spec("vertical_tilt"), height = spec("vertical_beam_width");
      const double steep = std::min(tilt + height / 2, 90.0);
      add("kind", "\"sidescan\"");
      add("along_track_deg", number(spec("horizontal_beam_width")));
      add("depression_min_deg", number(tilt - height / 2));
      add("depression_max_deg", number(steep));
      add("samples", number(even(node, "bins", spec("bins")) / 2));
      if (steep < tilt + height / 2)
        parts_.notice(node, fmt::format("sonar '{}': its two sides overlap below the sonar; in the imported "
                                        "scene, both end at the vertical",
                                        sonar.name));
      looks_down = true;
    } else {
      return parts_.notice(node,
                           fmt::format("sensor '{}' is left out: tubefoot does not read sensors of type '{}'",
                                       sonar.name, shown_line(type)));
    }
    constexpr double least_m = 0.02;  // of Stonefish's sonars
    add("range_min_m", number(std::max(least_m, xml_.attribute_number(settings, "range_min", 0.5))));
    add("range_max_m", number(xml_.attribute_number(settings, "range_max", 10)));
    parts_.notice(
        node,
        fmt::format("sonar '{}' has no frequency in Stonefish: the default of its kind is used", sonar.name));
    parts_.add_sensor(node, std::move(sonar), at, looks_down);
  }

  WorldParts& parts_;
  const XmlInput& xml_;
};

}  // namespace

void read_stonefish(WorldParts& parts) { StonefishReader(parts).read(); }

}  // namespace tubefoot
