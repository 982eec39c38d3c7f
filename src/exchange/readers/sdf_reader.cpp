// SPDX-License-Identifier: GPL-3.0-or-later
// Reads SDF worlds and models: links, visuals, frames with relative_to, and the sonar sensors of Gazebo and
// DAVE. It converts poses to the axes of tubefoot.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>

#include "exchange/readers/world_parts.hpp"
#include "files/shown.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

/// A world or a model: the elements among which relative_to of a pose looks up names, and the resolved
/// frames.
struct Scope {
  pugi::xml_node node;  ///< a world or a model
  Placement placed;     ///< placement in the world
  std::map<std::string, pugi::xml_node, std::less<>> frames{};
  std::map<std::string, std::optional<Placement>, std::less<>> known{};  ///< frames that were looked up

  Scope(pugi::xml_node of, const Placement& at) : node(of), placed(at) {
    for (const pugi::xml_node child : node.children())
      for (const char* what : {"model", "link", "frame"})
        if (std::string_view(child.name()) == what) frames.emplace(child.attribute("name").value(), child);
  }
};

class SdfReader {
 public:
  explicit SdfReader(WorldParts& parts) : parts_(parts), xml_(parts.xml()) {}

  void read() {
    pugi::xml_node world = xml_.root().child("world");
    for (pugi::xml_node other = world.next_sibling("world"); other; other = other.next_sibling("world"))
      parts_.notice(other, "a second <world> is left out");
    if (!world) world = xml_.root();  // the file contains models only
    parts_.read_own_scene(world);
    Scope scope(world, {});
    children(scope, {});
  }

 private:
  static bool is_any_of(std::string_view name, std::initializer_list<std::string_view> names) {
    return std::ranges::find(names, name) != names.end();
  }
  static std::string name_of(pugi::xml_node node) { return shown_line(node.attribute("name").value()); }

  /// Reads the children of a world or a model. `prefix`: "tug::" for the children of the model tug.
  void children(Scope& scope, const std::string& prefix) {
    for (const pugi::xml_node node : scope.node.children()) {
      if (node.type() != pugi::node_element) continue;
      const std::string_view name = node.name();
      if (name == "model") {
        if (node.attribute("placement_frame")) {
          parts_.notice(node, fmt::format("model '{}' is left out: tubefoot does not read placement_frame",
                                          name_of(node)));
          continue;
        }
        if (const auto placed = place_of(scope, node, 0)) {
          Scope inner(node, *placed);
          children(inner, prefix + name_of(node) + "::");
        }
      } else if (name == "link") {
        if (const auto placed = place_of(scope, node, 0)) link(node, *placed, prefix);
      } else if (name == "include") {
        parts_.notice(node, fmt::format("<include> of '{}' is left out: replace it by the model itself, or "
                                        "import the model separately",
                                        shown_line(node.child_value("uri"))));
      } else if (!is_any_of(name, {"pose", "static", "tubefoot:scene", "frame", "self_collide",
                                   "allow_auto_disable"})) {
        parts_.pass_over(node);
      }
    }
  }

  /// Returns the placement that the numbers of a <pose> describe.
  Placement pose_in(pugi::xml_node pose) const {
    if (!pose) return {};
    const std::string_view format = pose.attribute("rotation_format").as_string("euler_rpy");
    const std::string_view text = pose.child_value();
    if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) return {};
    if (format == "quat_xyzw") {
      const std::vector<double> v = xml_.numbers(pose, text, 7, "<pose>");
      if (!(std::hypot(std::hypot(v[3], v[4]), std::hypot(v[5], v[6])) > 1e-6))
        xml_.fail(pose, "the quaternion of <pose> is zero");
      return {{v[0], v[1], v[2]}, turn_of_quaternion({v[3], v[4], v[5], v[6]})};
    }
    if (format != "euler_rpy") xml_.fail(pose, "rotation_format must be euler_rpy or quat_xyzw");
    std::vector<double> v = xml_.numbers(pose, text, 6, "<pose>");
    if (pose.attribute("degrees").as_bool())
      for (std::size_t k = 3; k < 6; ++k) v[k] = radians(v[k]);
    return {{v[0], v[1], v[2]}, turn_of({v[3], v[4], v[5]})};
  }

  /// Returns the placement of a child of a scope in the world. Reports an unresolved frame and returns
  /// nothing.
  std::optional<Placement> place_of(Scope& scope, pugi::xml_node node, int depth) {
    constexpr int deepest = 32;
    const pugi::xml_node pose = node.child("pose");
    std::string frame = pose.attribute("relative_to").value();
    if (frame.empty()) frame = pose.attribute("frame").value();  // in versions before SDF 1.7
    if (frame.empty() && std::string_view(node.name()) == "frame")
      frame = node.attribute("attached_to").value();
    if (frame.empty() || frame == "__model__") return scope.placed * pose_in(pose);
    if (frame == "world") return pose_in(pose);
    if (const auto other = scope.frames.find(frame); other != scope.frames.end() && depth < deepest) {
      auto base = scope.known.find(frame);
      if (base == scope.known.end()) {
        const std::optional<Placement> found = place_of(scope, other->second, depth + 1);
        base = scope.known.insert_or_assign(frame, found).first;
      }
      if (!base->second) return {};
      return *base->second * pose_in(pose);
    }
    parts_.notice(node, fmt::format("<{}> '{}' is left out: its pose is relative to '{}', which is not a "
                                    "sibling model, link or frame",
                                    name_in(node), name_of(node), shown_line(frame)));
    return {};
  }

  void link(pugi::xml_node link, const Placement& placed, const std::string& prefix) {
    const bool has_visuals = static_cast<bool>(link.child("visual"));
    if (!has_visuals && link.child("collision"))
      parts_.notice(link, fmt::format("link '{}' has no <visual>: tubefoot uses its <collision> instead",
                                      name_of(link)));
    for (const pugi::xml_node node : link.children()) {
      if (node.type() != pugi::node_element) continue;
      const std::string_view name = node.name();
      const std::optional<Placement> inner =
          is_any_of(name, {"visual", "collision", "sensor"}) ? inner_place(node, placed) : std::nullopt;
      if (name == (has_visuals ? "visual" : "collision")) {
        if (inner) geometry(node, *inner, prefix);
      } else if (name == "sensor") {
        if (inner) sensor(node, placed, *inner);
      } else if (!is_any_of(name,
                            {"pose", "collision", "inertial", "gravity", "kinematic", "self_collide"})) {
        parts_.pass_over(node);
      }
    }
  }

  std::optional<Placement> inner_place(pugi::xml_node node, const Placement& link) {
    const pugi::xml_node pose = node.child("pose");
    const std::string_view frame = pose.attribute("relative_to").value();
    if (frame.empty()) return link * pose_in(pose);
    parts_.notice(node, fmt::format("<{}> '{}' is left out: its pose is relative to '{}', not to its link",
                                    name_in(node), name_of(node), shown_line(frame)));
    return {};
  }

  double positive(pugi::xml_node node, const char* child) const {
    const double value = xml_.child_number(node, child, 0);
    if (!(value > 0)) xml_.fail(node, fmt::format("<{}> of <{}> must be above 0", child, name_in(node)));
    return value;
  }

  void geometry(pugi::xml_node visual, const Placement& placed, const std::string& prefix) {
    ImportedObject object;
    object.name = prefix + name_of(visual.parent()) + "::" + name_of(visual);
    if (visual.child("tubefoot:material")) object.name = name_of(visual.parent().parent());
    const pugi::xml_node shape = visual.child("geometry").first_child();
    const std::string_view what = shape.name();
    const auto number = [](double value) { return fmt::format("{}", value); };
    object.shape = what;
    Placement at = placed;
    if (what == "mesh") {
      if (shape.child("submesh"))
        return parts_.notice(
            shape, fmt::format("'{}' is left out: it uses only a <submesh> of its mesh", object.name));
      object.mesh = parts_.mesh(shape, shape.child_value("uri"));
      if (!object.mesh) return;
      if (const pugi::xml_node scale = shape.child("scale")) {
        const std::vector<double> v = xml_.numbers(scale, scale.child_value(), 3, "<scale>");
        object.scale = {v[0], v[1], v[2]};
      }
    } else if (what == "box") {
      const pugi::xml_node size = shape.child("size");
      const std::vector<double> v =
          xml_.numbers(size ? size : shape, size.child_value(), 3, "<size> of <box>");
      object.keys = {{"size_m", fmt::format("[{}, {}, {}]", v[0], v[1], v[2])}};
    } else if (what == "sphere") {
      object.keys = {{"radius_m", number(positive(shape, "radius"))}};
    } else if (what == "ellipsoid") {
      const pugi::xml_node radii = shape.child("radii");
      const std::vector<double> v = xml_.numbers(radii ? radii : shape, radii.child_value(), 3, "<radii>");
      object.shape = "sphere";
      object.keys = {{"radius_m", "1"}};
      object.scale = {v[0], v[1], v[2]};
    } else if (what == "cylinder" || what == "cone") {
      object.keys = {{"radius_m", number(positive(shape, "radius"))},
                     {"height_m", number(positive(shape, "length"))}};
    } else if (what == "plane") {
      at = plane(shape, placed, object);
    } else {
      return parts_.notice(visual, fmt::format("'{}' is left out: tubefoot does not read the shape <{}>",
                                               object.name, name_in(shape)));
    }
    object.material = parts_.material(material_of(visual));
    parts_.add_object(visual, std::move(object), at);
  }

  Placement plane(pugi::xml_node shape, const Placement& placed, ImportedObject& object) {
    const pugi::xml_node size = shape.child("size"), normal = shape.child("normal");
    const std::vector<double> v =
        size ? xml_.numbers(size, size.child_value(), 2, "<size> of <plane>") : std::vector<double>{1, 1};
    object.shape = "mesh";
    object.mesh = parts_.mesh("plane", plane_mesh(v[0], v[1]));
    if (!normal) return placed;
    const std::vector<double> n = xml_.numbers(normal, normal.child_value(), 3, "<normal>");
    const glm::dvec3 up(n[0], n[1], n[2]);
    if (!(glm::length(up) > 1e-6)) xml_.fail(normal, "the vector of <normal> is zero");
    const glm::dvec3 z = glm::normalize(up);
    if (z == glm::dvec3(0, 0, 1)) return placed;
    // The smallest rotation that brings z there, up to a rotation about z.
    const glm::dvec3 aside = std::abs(z.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 y = glm::normalize(glm::cross(z, aside)), x = glm::cross(y, z);
    return {placed.position_m, placed.turn * glm::dmat3(x, y, z)};
  }

  static std::string material_of(pugi::xml_node visual) {
    if (const pugi::xml_node own = visual.child("tubefoot:material")) return own.attribute("name").value();
    return visual.child("material").child("script").child_value("name");
  }

  void sensor(pugi::xml_node node, const Placement& link, const Placement& placed) {
    if (parts_.add_own_sonar(node, link, parts_.axes().sonar)) return;
    if (const pugi::xml_node block = node.child("gz:multibeam_sonar"))
      return fan(node, block, block.child("ray"), placed);
    const std::string_view type = node.attribute("type").value();
    for (const pugi::xml_node plugin : node.children("plugin"))
      if (std::string_view(plugin.attribute("filename").value()).find("multibeam_sonar") !=
          std::string_view::npos) {
        if (const pugi::xml_node camera = node.child("camera")) return raster(node, plugin, camera, placed);
        return fan(node, plugin, node.child("ray"), placed);
      }
    if (is_any_of(type, {"ray", "gpu_ray", "lidar", "gpu_lidar"})) {
      const pugi::xml_node scan = node.child("ray") ? node.child("ray") : node.child("lidar");
      return fan(node, {}, scan, placed);
    }
    parts_.notice(node, fmt::format("sensor '{}' is left out: tubefoot does not read sensors of type '{}'",
                                    name_of(node), shown_line(type)));
  }

  /// Returns the number of samples. A bandwidth B resolves c / (2 B).
  std::string samples_of(pugi::xml_node node, pugi::xml_node spec, double length_m) {
    const double bandwidth = xml_.child_number(spec, "bandwidth", 0),
                 speed = xml_.child_number(spec, "soundSpeed", 1500);
    constexpr double usual = 512, most = 65536;
    double samples = bandwidth > 0 ? std::round(length_m * 2 * bandwidth / speed) : usual;
    samples = std::clamp(samples, 1.0, most);
    parts_.notice(
        node, fmt::format("sensor '{}' does not state its number of range samples: {} samples are assumed{}",
                          name_of(node), samples, bandwidth > 0 ? " from its bandwidth" : ""));
    return fmt::format("{}", samples);
  }

  void add_frequency(pugi::xml_node spec, ImportedSensor& sensor) {
    if (const double hertz = xml_.child_number(spec, "sonarFreq", 0); hertz > 0)
      sensor.keys.emplace_back("frequency_khz", fmt::format("{}", hertz / 1000));
  }

  /// Reads a fan: beams between two angles about z, and rays between two angles about y.
  void fan(pugi::xml_node node, pugi::xml_node block, pugi::xml_node ray, const Placement& placed) {
    const pugi::xml_node spec = block.child("spec") ? block.child("spec") : block;
    const pugi::xml_node across = ray.child("scan").child("horizontal"),
                         up = ray.child("scan").child("vertical");
    const double beams = xml_.child_number(across, across.child("beams") ? "beams" : "samples", 0);
    const double unit = ray.attribute("degrees").as_bool() ? 1 : 180 / std::numbers::pi;
    const double low = unit * xml_.child_number(across, "min_angle", 0),
                 high = unit * xml_.child_number(across, "max_angle", 0);
    const double below = unit * xml_.child_number(up, "min_angle", 0),
                 above = unit * xml_.child_number(up, "max_angle", 0);
    if (!(above > below))
      return parts_.notice(
          node,
          fmt::format(
              "sensor '{}' is left out: its rays lie in one plane, but the beams of a sonar need a height",
              name_of(node)));
    const double near = xml_.child_number(ray.child("range"), "min", 0),
                 far = xml_.child_number(ray.child("range"), "max", 0);
    ImportedSensor sensor;
    sensor.name = name_of(node);
    sensor.keys = {{"kind", "\"imaging\""},
                   {"beams", fmt::format("{}", beams)},
                   {"horizontal_deg", fmt::format("{}", high - low)},
                   {"vertical_deg", fmt::format("{}", above - below)},
                   {"range_min_m", fmt::format("{}", near)},
                   {"range_max_m", fmt::format("{}", far)},
                   {"samples", samples_of(node, spec, far - near)}};
    add_frequency(spec, sensor);
    // Rotates to the centre of the fan: about z to port, then about y downwards.
    const glm::dmat3 middle = turn_of({0, -radians((below + above) / 2), radians((low + high) / 2)});
    parts_.add_sensor(node, std::move(sensor), {placed.position_m, placed.turn * middle});
  }

  /// Reads the older plugin of DAVE: the columns of a depth camera are equidistant beams.
  void raster(pugi::xml_node node, pugi::xml_node plugin, pugi::xml_node camera, const Placement& placed) {
    const double near = xml_.child_number(camera.child("clip"), "near", 0),
                 far = xml_.child_number(camera.child("clip"), "far", 0);
    ImportedSensor sensor;
    sensor.name = name_of(node);
    sensor.keys = {
        {"kind", "\"imaging\""},
        {"beams", fmt::format("{}", xml_.child_number(camera.child("image"), "width", 0))},
        {"horizontal_deg", fmt::format("{}", degrees(xml_.child_number(camera, "horizontal_fov", 0)))},
        {"vertical_deg", fmt::format("{}", xml_.child_number(plugin, "verticalFOV", 0))},
        {"spacing", "\"distance\""},
        {"range_min_m", fmt::format("{}", near)},
        {"range_max_m", fmt::format("{}", far)},
        {"samples", samples_of(node, plugin, far - near)}};
    add_frequency(plugin, sensor);
    parts_.add_sensor(node, std::move(sensor), placed);
  }

  WorldParts& parts_;
  const XmlInput& xml_;
};

}  // namespace

void read_sdf(WorldParts& parts) { SdfReader(parts).read(); }

}  // namespace tubefoot
