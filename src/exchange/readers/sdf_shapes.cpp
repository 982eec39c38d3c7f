// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the shapes of SDF visuals and collisions: meshes and their parts, primitives, planes and extruded
// outlines.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "exchange/readers/sdf_frames.hpp"
#include "exchange/readers/sdf_parts.hpp"
#include "files/shown.hpp"
#include "scene/meshes/mesh_file_polygons.hpp"

namespace tubefoot {
namespace {

class SdfShape {
 public:
  SdfShape(WorldParts& parts, pugi::xml_node visual, const Placement& placed, std::string name)
      : parts_(parts), xml_(parts.xml()), visual_(visual), placed_(placed), name_(std::move(name)) {}

  void read() {
    if (visual_.child("tubefoot:material")) name_ = sdf_name_of(visual_.parent().parent());
    const pugi::xml_node geometry = visual_.child("geometry");
    pugi::xml_node shape = geometry.first_child();
    while (shape && shape.type() != pugi::node_element) shape = shape.next_sibling();
    const std::string_view what = shape.name();
    if (!shape || what == "empty") return parts_.without_effect(shape ? shape : visual_);
    if (what == "mesh")
      mesh(shape);
    else if (what == "box")
      box(shape);
    else if (what == "sphere")
      add("sphere", {{"radius_m", text(positive(shape, "radius", 1))}});
    else if (what == "ellipsoid")
      ellipsoid(shape);
    else if (what == "cylinder" || what == "cone")
      add(std::string(what), {{"radius_m", text(positive(shape, "radius", 1))},
                              {"height_m", text(positive(shape, "length", 1))}});
    else if (what == "capsule")
      capsule(shape);
    else if (what == "plane")
      plane(shape);
    else if (what == "polyline")
      outline(geometry);
    else
      parts_.notice(visual_, fmt::format("'{}' is left out: tubefoot does not read the shape <{}>", name_,
                                         name_in(shape)));
  }

 private:
  using Keys = std::vector<std::pair<std::string, std::string>>;
  static std::string text(double value) { return fmt::format("{}", value); }

  double positive(pugi::xml_node node, const char* child, double otherwise) const {
    const double value = xml_.child_number(node, child, otherwise);
    if (!(value > 0)) xml_.fail(node, fmt::format("<{}> of <{}> must be above 0", child, name_in(node)));
    return value;
  }

  std::vector<double> numbers(pugi::xml_node node, const char* child, std::vector<double> otherwise) const {
    const pugi::xml_node found = node.child(child);
    if (!found) return otherwise;
    return xml_.numbers(found, found.child_value(), otherwise.size(),
                        fmt::format("<{}> of <{}>", child, name_in(node)));
  }

  ImportedObject object(std::string shape, Keys keys) {
    ImportedObject made;
    made.name = name_;
    made.shape = std::move(shape);
    made.keys = std::move(keys);
    const pugi::xml_node own = visual_.child("tubefoot:material"), script = visual_.child("material");
    made.material = parts_.material(own ? own.attribute("name").value()
                                        : trimmed(script.child("script").child_value("name")));
    return made;
  }
  void add(std::string shape, Keys keys) {
    parts_.add_object(visual_, object(std::move(shape), std::move(keys)), placed_);
  }
  void add_mesh(std::size_t mesh, const Placement& placed, const std::vector<double>& scale = {1, 1, 1}) {
    ImportedObject made = object("mesh", {});
    made.mesh = mesh;
    made.scale = {scale[0], scale[1], scale[2]};
    parts_.add_object(visual_, std::move(made), placed);
  }

  void mesh(pugi::xml_node shape) {
    const pugi::xml_node part = shape.child("submesh");
    const SubMesh used{trimmed(part.child_value("name")), sdf_true(part.child_value("center"))};
    if (const auto found = parts_.mesh(shape, trimmed(shape.child_value("uri")), used))
      add_mesh(*found, placed_, numbers(shape, "scale", {1, 1, 1}));
  }

  void box(pugi::xml_node shape) {
    const std::vector<double> v = numbers(shape, "size", {1, 1, 1});
    add("box", {{"size_m", fmt::format("[{}, {}, {}]", v[0], v[1], v[2])}});
  }

  void ellipsoid(pugi::xml_node shape) {
    ImportedObject made = object("sphere", {{"radius_m", "1"}});
    const std::vector<double> v = numbers(shape, "radii", {1, 1, 1});
    made.scale = {v[0], v[1], v[2]};
    parts_.add_object(visual_, std::move(made), placed_);
  }

  /// A cylinder between two spheres. The hidden halves of the spheres receive no sound.
  void capsule(pugi::xml_node shape) {
    const double radius_m = positive(shape, "radius", 0.5), length_m = positive(shape, "length", 1);
    add("cylinder", {{"radius_m", text(radius_m)}, {"height_m", text(length_m)}});
    for (const double end : {-0.5, 0.5})
      parts_.add_object(visual_, object("sphere", {{"radius_m", text(radius_m)}}),
                        placed_ * Placement{{0, 0, end * length_m}, glm::dmat3(1)});
  }

  void plane(pugi::xml_node shape) {
    const std::vector<double> size = numbers(shape, "size", {1, 1}), n = numbers(shape, "normal", {0, 0, 1});
    if (!(size[0] > 0 && size[1] > 0)) xml_.fail(shape, "<size> of <plane> must be above 0");
    const glm::dvec3 up(n[0], n[1], n[2]);
    if (!(glm::length(up) > 1e-6)) xml_.fail(shape, "the vector of <normal> is zero");
    const glm::dvec3 z = glm::normalize(up);
    Placement at = placed_;
    if (z != glm::dvec3(0, 0, 1)) {
      // The smallest rotation that brings z there, up to a rotation about z.
      const glm::dvec3 aside = std::abs(z.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
      const glm::dvec3 y = glm::normalize(glm::cross(z, aside)), x = glm::cross(y, z);
      at.turn = at.turn * glm::dmat3(x, y, z);
    }
    add_mesh(parts_.mesh("plane", plane_mesh(size[0], size[1])), at);
  }

  /// A prism: the outline at z = 0, extruded upwards.
  void outline(pugi::xml_node geometry) {
    const pugi::xml_node shape = geometry.child("polyline");
    if (shape.next_sibling("polyline"))
      return parts_.notice(visual_, fmt::format("'{}' is left out: its outline has holes or several parts, "
                                                "but tubefoot reads one <polyline>",
                                                name_));
    const double height_m = positive(shape, "height", 1);
    std::vector<std::vector<double>> points;
    for (const pugi::xml_node point : shape.children("point"))
      points.push_back(xml_.numbers(point, point.child_value(), 2, "<point>"));
    if (points.size() > 1 && points.front() == points.back()) points.pop_back();
    constexpr std::size_t most = 10'000;
    if (points.size() < 3 || points.size() > most)
      return parts_.notice(visual_,
                           fmt::format("'{}' is left out: its outline has {} points, expected 3 to {}", name_,
                                       points.size(), most));
    double twice_area = 0;
    const std::size_t count = points.size();
    for (std::size_t k = 0; k < count; ++k) {
      const auto &a = points[k], &b = points[(k + 1) % count];
      twice_area += a[0] * b[1] - a[1] * b[0];
    }
    if (twice_area < 0) std::ranges::reverse(points);
    UncheckedPolygons prism;
    for (const double z : {0.0, height_m})
      for (const auto& point : points) prism.points.emplace_back(point[0], point[1], z);
    const auto corner = [&](std::size_t k, bool top) {
      prism.corners.push_back(static_cast<std::uint32_t>(k % count + (top ? count : 0)));
    };
    for (std::size_t k = 0; k < count; ++k) corner(count - 1 - k, false);
    prism.end_polygon();
    for (std::size_t k = 0; k < count; ++k) corner(k, true);
    prism.end_polygon();
    for (std::size_t k = 0; k < count; ++k) {
      corner(k, false);
      corner(k + 1, false);
      corner(k + 1, true);
      corner(k, true);
      prism.end_polygon();
    }
    try {
      add_mesh(parts_.mesh("outline", triangulate(std::move(prism), "<polyline>")), placed_);
    } catch (const InputError& error) {
      parts_.notice(visual_, fmt::format("'{}' is left out: {}", name_, error.what()));
    }
  }

  WorldParts& parts_;
  const XmlInput& xml_;
  pugi::xml_node visual_;
  Placement placed_;
  std::string name_;
};

}  // namespace

void read_sdf_shape(WorldParts& parts, pugi::xml_node visual, const Placement& placed, std::string name) {
  SdfShape(parts, visual, placed, std::move(name)).read();
}

}  // namespace tubefoot
