// SPDX-License-Identifier: GPL-3.0-or-later

// Creates the meshes of the benchmark suite (plates, boxes and spheres), and rounds their vertices to
// multiples of 2^-10 m. It writes them as Wavefront OBJ and binary STL.

#include "suite/solids.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <numbers>

namespace tubefoot {
namespace {

constexpr double radian = std::numbers::pi / 180, steps_a_metre = 1024;

void quad(Solid& solid, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  solid.facets.push_back({a, b, c});
  solid.facets.push_back({a, c, d});
}

void put(std::string& bytes, std::uint32_t value, int count) {
  for (int k = 0; k < count; ++k) bytes += static_cast<char>(value >> (8 * k) & 0xff);
}

void put(std::string& bytes, glm::dvec3 v) {
  for (const double x : {v.x, v.y, v.z}) put(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(x)), 4);
}

}  // namespace

Solid level_plate(const std::string& name, const std::string& material, glm::dvec3 centre, double width,
                  double length) {
  const glm::dvec3 east{width / 2, 0, 0}, north{0, length / 2, 0};
  Solid plate{name,
              material,
              {centre - east - north, centre + east - north, centre + east + north, centre - east + north},
              {}};
  quad(plate, 0, 1, 2, 3);
  return plate;
}

Solid upright_plate(const std::string& name, const std::string& material, glm::dvec3 centre,
                    double heading_deg, double width, double height) {
  const glm::dvec3 right = glm::dvec3{std::cos(heading_deg * radian), -std::sin(heading_deg * radian), 0} *
                           (width / 2),
                   up{0, 0, height / 2};
  Solid plate{name,
              material,
              {centre - right - up, centre + right - up, centre + right + up, centre - right + up},
              {}};
  quad(plate, 0, 1, 2, 3);
  return plate;
}

Solid box(const std::string& name, const std::string& material, glm::dvec3 centre, glm::dvec3 size,
          double heading_deg) {
  const double c = std::cos(heading_deg * radian), s = std::sin(heading_deg * radian);
  Solid solid{name, material, {}, {}};
  for (const double z : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5})
      for (const double x : {-0.5, 0.5})
        solid.vertices_m.push_back(centre + glm::dvec3{c * x * size.x + s * y * size.y,
                                                       -s * x * size.x + c * y * size.y, z * size.z});
  quad(solid, 0, 2, 3, 1);
  quad(solid, 4, 5, 7, 6);
  quad(solid, 0, 1, 5, 4);
  quad(solid, 2, 6, 7, 3);
  quad(solid, 0, 4, 6, 2);
  quad(solid, 1, 3, 7, 5);
  return solid;
}

Solid sphere(const std::string& name, const std::string& material, glm::dvec3 centre, double radius,
             int rings, int sectors) {
  Solid solid{name, material, {centre - glm::dvec3{0, 0, radius}}, {}};
  for (int ring = 1; ring < rings; ++ring) {
    const double polar = std::numbers::pi * ring / rings;
    for (int sector = 0; sector < sectors; ++sector) {
      const double turn = 2 * std::numbers::pi * sector / sectors;
      solid.vertices_m.push_back(centre + radius * glm::dvec3{std::sin(polar) * std::cos(turn),
                                                              std::sin(polar) * std::sin(turn),
                                                              -std::cos(polar)});
    }
  }
  solid.vertices_m.push_back(centre + glm::dvec3{0, 0, radius});
  const auto around = static_cast<std::uint32_t>(sectors);
  const auto top = static_cast<std::uint32_t>(solid.vertices_m.size() - 1);
  for (std::uint32_t sector = 0; sector < around; ++sector) {
    const std::uint32_t following = (sector + 1) % around;
    solid.facets.push_back({0, 1 + following, 1 + sector});
    solid.facets.push_back({top, top - around + sector, top - around + following});
    for (std::uint32_t ring = 0; ring + 2 < static_cast<std::uint32_t>(rings); ++ring) {
      const std::uint32_t a = 1 + ring * around + sector, b = 1 + ring * around + following;
      quad(solid, a, b, b + around, a + around);
    }
  }
  return solid;
}

void add(Solid& solid, const Solid& more) {
  const auto first = static_cast<std::uint32_t>(solid.vertices_m.size());
  solid.vertices_m.insert(solid.vertices_m.end(), more.vertices_m.begin(), more.vertices_m.end());
  for (const auto& [a, b, c] : more.facets) solid.facets.push_back({first + a, first + b, first + c});
}

void snap(Solid& solid) {
  for (glm::dvec3& v : solid.vertices_m)
    for (int k = 0; k < 3; ++k) v[k] = std::round(v[k] * steps_a_metre) / steps_a_metre + 0.0;
}

std::string obj_text(const Solid& solid) {
  std::string text =
      fmt::format("# {}: {} facets, metres, x east, y north, z up\n", solid.name, solid.facets.size());
  for (const glm::dvec3& v : solid.vertices_m)
    fmt::format_to(std::back_inserter(text), "v {} {} {}\n", v.x, v.y, v.z);
  for (const auto& [a, b, c] : solid.facets)
    fmt::format_to(std::back_inserter(text), "f {} {} {}\n", a + 1, b + 1, c + 1);
  return text;
}

std::string stl_bytes(const Solid& solid) {
  std::string bytes = "binary STL, metres, x east, y north, z up";
  bytes.resize(80, ' ');
  put(bytes, static_cast<std::uint32_t>(solid.facets.size()), 4);
  for (const auto& [a, b, c] : solid.facets) {
    const glm::dvec3 &p = solid.vertices_m[a], &q = solid.vertices_m[b], &r = solid.vertices_m[c];
    const glm::dvec3 normal = glm::cross(q - p, r - p);
    const double length = glm::length(normal);
    put(bytes, length > 0 ? normal / length : glm::dvec3{0});
    for (const glm::dvec3& v : {p, q, r}) put(bytes, v);
    put(bytes, 0, 2);
  }
  return bytes;
}

}  // namespace tubefoot
