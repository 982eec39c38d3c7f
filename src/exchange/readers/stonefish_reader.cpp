// SPDX-License-Identifier: GPL-3.0-or-later
// Reads Stonefish scenarios: bodies with their meshes and primitives, robots, materials, and the sonars fls,
// msis and sss.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "exchange/readers/world_parts.hpp"
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
    const Placement placed = transform(node.child("world_transform"));
    if (std::string_view(node.name()) != "static")
      parts_.notice(
          node, fmt::format("'{}' moves in Stonefish: here it stays at its initial position", name_of(node)));
    shape(node, placed);
    for (const pugi::xml_node inner : node.children("sensor")) sensor(inner, placed, inner.child("origin"));
  }

  void shape(pugi::xml_node node, Placement placed) {
    ImportedObject object;
    object.name = name_of(node);
    const std::string_view type = node.attribute("type").value();
    const pugi::xml_node size = node.child("dimensions");
    object.shape = type;
    if (type == "model") {
      const pugi::xml_node seen = node.child("visual") ? node.child("visual") : node.child("physical");
      const pugi::xml_node mesh = seen.child("mesh");
      object.shape = "mesh";
      object.mesh = parts_.mesh(mesh ? mesh : node, mesh.attribute("filename").value());
      if (!object.mesh) return;
      const double scale = xml_.attribute_number(mesh, "scale", 1);
      object.scale = {scale, scale, scale};
      placed = placed * transform(seen.child("origin"));
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
      constexpr double side_m = 1000;  // side of the plane that Stonefish draws
      object.shape = "mesh";
      object.mesh = parts_.mesh("plane", plane_mesh(side_m, side_m));
      parts_.notice(node, fmt::format("plane '{}' is infinite in Stonefish: here it is {} m wide",
                                      object.name, side_m));
    } else {
      return parts_.notice(node, fmt::format("'{}' is left out: tubefoot does not read shapes of type \"{}\"",
                                             object.name, shown_line(type)));
    }
    if (type != "model") placed = placed * transform(node.child("origin"));
    object.material = parts_.material(node.child("material").attribute("name").value());
    parts_.add_object(node, std::move(object), placed);
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

  /// Stonefish draws a forward-looking sonar as adjacent views of at most 20 degrees. The beams of each
  /// view are equidistant.
  void fan(pugi::xml_node node, ImportedSensor& sonar, double beams, double width_deg) {
    constexpr double widest_view_deg = 20, most_beams = 4096;
    const double views = std::ceil(width_deg / widest_view_deg), of_view = beams / views;
    const bool even =
        !(views >= 1 && of_view >= 1 && of_view == std::floor(of_view) && beams >= 2 && beams <= most_beams);
    if (even) {
      sonar.keys.emplace_back("beams", fmt::format("{}", beams));
      sonar.keys.emplace_back("horizontal_deg", fmt::format("{}", width_deg));
    } else {
      std::vector<double> angles;
      const double half_deg = width_deg / views / 2, half = std::tan(radians(half_deg));
      for (double view = 0; view < views; ++view)
        for (double beam = 0; beam < of_view; ++beam)
          angles.push_back((2 * view + 1 - views) * half_deg +
                           degrees(std::atan(half * ((2 * beam + 1) / of_view - 1))));
      sonar.keys.emplace_back("beam_angles_deg", fmt::format("[{}]", fmt::join(angles, ", ")));
    }
    parts_.notice(
        node, even
                  ? fmt::format("sonar '{}': its {} beams do not divide into {} equal views of at most 20 "
                                "degrees; equiangular beams are assumed",
                                sonar.name, beams, views)
                  : fmt::format("sonar '{}': equidistant beams are assumed in each of {} views, as in an FLS",
                                sonar.name, views));
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
      add("samples", number(spec("bins")));
    } else if (type == "msis") {
      const double low = xml_.attribute_number(settings, "rotation_min", -180),
                   high = xml_.attribute_number(settings, "rotation_max", 180);
      add("kind", "\"scanning\"");
      add("scan_deg", number(high - low));
      add("step_deg", number(spec("step")));
      add("beam_horizontal_deg", number(spec("horizontal_beam_width")));
      add("beam_vertical_deg", number(spec("vertical_beam_width")));
      add("samples", number(spec("bins")));
      // The sonar rotates to starboard, which is about y, downwards.
      at.turn = placed.turn * turn_of({0, radians((low + high) / 2), 0});
    } else if (type == "sss") {
      const double tilt = spec("vertical_tilt"), height = spec("vertical_beam_width");
      const double steep = std::min(tilt + height / 2, 90.0);
      add("kind", "\"sidescan\"");
      add("along_track_deg", number(spec("horizontal_beam_width")));
      add("depression_min_deg", number(tilt - height / 2));
      add("depression_max_deg", number(steep));
      add("samples", number(std::floor(spec("bins") / 2)));
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
    add("range_min_m", number(xml_.attribute_number(settings, "range_min", 0.5)));
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
