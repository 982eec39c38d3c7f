// SPDX-License-Identifier: GPL-3.0-or-later

// Creates spheres, cylinders, cones and boxes as closed triangle meshes with the area of the true surface
// and a bounded chord error. A sphere is a geodesic subdivision of an icosahedron.

#include "scene/meshes/primitives.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "files/limits.hpp"
#include "files/memory_at_hand.hpp"

namespace tubefoot {
namespace {

void check_size(double size_m, const char* what, const SourcePlace& place) {
  if (!(size_m > 0) || !std::isfinite(size_m)) {
    throw InputError(place, fmt::format("{} is {} m, expected more than 0", what, size_m));
  }
}

void check_facets(double facets, double chord_error_m, const SourcePlace& place) {
  if (!(facets <= limits::primitive_facets)) {
    throw InputError(place, fmt::format("a chord error of {} m would need {:.3g} facets, but at most {:.3g} "
                                        "are allowed: give a larger chord_error_m",
                                        chord_error_m, facets, limits::primitive_facets));
  }
  require_memory(bytes_a_facet * facets, place, fmt::format("{:.3g} facets", facets),
                 "give a larger chord_error_m");
}

// Returns the number of sides of a regular polygon in a circle. Its sagitta radius (1 - cos(pi / n)) is at
// most the chord error.
double polygon_sides(double radius_m, double chord_error_m) {
  // 1 - cos a = 2 sin^2(a/2) is accurate for small errors.
  const double half_angle = 2 * std::asin(std::min(1.0, std::sqrt(chord_error_m / (2 * radius_m))));
  return std::max(3.0, std::ceil(std::numbers::pi / half_angle));
}

// Returns the factor by which a prism, pyramid or frustum must be wider than the cylinder or cone for equal
// areas of the sides.
double widening(const ConePrimitive& cone, double sides) {
  const double half_angle = std::numbers::pi / sides, sum = cone.radius_m + cone.top_radius_m,
               lean = std::abs(cone.radius_m - cone.top_radius_m);
  const double wanted = std::numbers::pi * sum * std::hypot(cone.height_m, lean);
  // n sin(pi / n) (R + r) k sqrt(h^2 + (lean k cos(pi / n))^2) grows with k, and its square is quadratic in
  // k^2.
  const double a = std::pow(sides * std::sin(half_angle) * sum, 2), h2 = cone.height_m * cone.height_m,
               l2 = std::pow(lean * std::cos(half_angle), 2);
  const double root = std::sqrt(h2 * h2 + 4 * l2 * wanted * wanted / a);
  return std::sqrt(2 * wanted * wanted / a / (h2 + root));
}

// Regular icosahedron in the unit sphere, with poles on z and two rings of five vertices.
struct Icosahedron {
  std::array<glm::dvec3, 12> corner;
  std::array<std::array<int, 3>, 20> face;
  std::array<std::array<int, 12>, 12> edge{};  // number of the edge between two corners

  Icosahedron() {
    const double z = 1 / std::sqrt(5.0), r = 2 * z;
    corner[0] = {0, 0, 1};
    corner[11] = {0, 0, -1};
    for (int k = 0; k < 5; ++k) {
      const double a = k * 2 * std::numbers::pi / 5, b = a + std::numbers::pi / 5;
      corner[1 + k] = {r * std::cos(a), r * std::sin(a), z};
      corner[6 + k] = {r * std::cos(b), r * std::sin(b), -z};
    }
    auto* out = face.begin();
    for (int k = 0; k < 5; ++k) {
      const int next = (k + 1) % 5, upper = 1 + k, upper_next = 1 + next, lower = 6 + k,
                lower_next = 6 + next;
      *out++ = {0, upper, upper_next};
      *out++ = {upper, lower, upper_next};
      *out++ = {upper_next, lower, lower_next};
      *out++ = {11, lower_next, lower};
    }
    int edges = 0;
    for (const auto& f : face) {
      for (int k = 0; k < 3; ++k) {
        const int a = f[k], b = f[(k + 1) % 3];
        if (a < b) edge[a][b] = edge[b][a] = edges++;
      }
    }
  }
};

// The icosahedron with its edges divided into `parts`, projected to the unit sphere. All its faces are
// congruent.
class Geodesic {
 public:
  explicit Geodesic(int parts) : parts_(parts) {}

  // Returns the point of a face with barycentric integers (parts - j - k, j, k).
  glm::dvec3 point(int face, int j, int k) const {
    const auto& f = ico_.face[face];
    return glm::normalize(static_cast<double>(parts_ - j - k) * ico_.corner[f[0]] +
                          static_cast<double>(j) * ico_.corner[f[1]] +
                          static_cast<double>(k) * ico_.corner[f[2]]);
  }

  // Returns the shared number of the point. Corners come first, then points on edges, then points inside
  // faces.
  std::uint32_t number(int face, int j, int k) const {
    const auto& f = ico_.face[face];
    const std::array<int, 3> weight = {parts_ - j - k, j, k};
    for (int m = 0; m < 3; ++m) {
      if (weight[m] == parts_) return static_cast<std::uint32_t>(f[m]);
    }
    for (int m = 0; m < 3; ++m) {
      if (weight[m] != 0) continue;
      const int a = (m + 1) % 3, b = (m + 2) % 3;
      const int from_lower = f[a] < f[b] ? weight[b] : weight[a];
      return static_cast<std::uint32_t>(12 + ico_.edge[f[a]][f[b]] * (parts_ - 1) + from_lower - 1);
    }
    const int inside = (parts_ - 1) * (parts_ - 2) / 2, rows = k - 1;
    const int before = rows * (parts_ - 1) - rows * (rows + 1) / 2;  // rows of parts-2, parts-3, ... points
    return static_cast<std::uint32_t>(12 + 30 * (parts_ - 1) + face * inside + before + j - 1);
  }

  template <typename Visit>  // visit(j, k, j, k, j, k) for each triangle of a face
  void for_each_triangle(Visit visit) const {
    for (int k = 0; k < parts_; ++k) {
      for (int j = 0; j + k < parts_; ++j) {
        visit(j, k, j + 1, k, j, k + 1);
        if (j + k + 2 <= parts_) visit(j + 1, k, j + 1, k + 1, j, k + 1);
      }
    }
  }

  // Returns the largest distance between the unit sphere and the facets. A facet is deepest where the
  // normal of its plane meets the sphere.
  double chord_error() const {
    double error = 0;
    for_each_triangle([&](int j0, int k0, int j1, int k1, int j2, int k2) {
      const glm::dvec3 a = point(0, j0, k0), b = point(0, j1, k1), c = point(0, j2, k2);
      error = std::max(error, 1 - std::abs(glm::dot(a, glm::normalize(glm::cross(b - a, c - a)))));
    });
    return error;
  }

  // Returns the area of all facets on the unit sphere.
  double area() const {
    double face = 0;
    for_each_triangle([&](int j0, int k0, int j1, int k1, int j2, int k2) {
      const glm::dvec3 a = point(0, j0, k0), b = point(0, j1, k1), c = point(0, j2, k2);
      face += glm::length(glm::cross(b - a, c - a)) / 2;
    });
    return 20 * face;
  }

  ComponentMesh facets(double radius_m) const {
    ComponentMesh mesh;
    mesh.points_m.resize(static_cast<std::size_t>(10) * parts_ * parts_ + 2);
    mesh.triangles.reserve(static_cast<std::size_t>(20) * parts_ * parts_);
    for (int face = 0; face < 20; ++face) {
      for (int k = 0; k <= parts_; ++k) {
        for (int j = 0; j + k <= parts_; ++j)
          mesh.points_m[number(face, j, k)] = radius_m * point(face, j, k);
      }
      for_each_triangle([&](int j0, int k0, int j1, int k1, int j2, int k2) {
        mesh.triangles.push_back({number(face, j0, k0), number(face, j1, k1), number(face, j2, k2)});
      });
    }
    return mesh;
  }

 private:
  int parts_;
  Icosahedron ico_;
};

}  // namespace

ComponentMesh sphere_facets(const SpherePrimitive& sphere, double chord_error_m, const SourcePlace& place) {
  check_size(sphere.radius_m, "radius_m", place);
  check_size(chord_error_m, "chord_error_m", place);
  const double wanted = chord_error_m / sphere.radius_m;
  // The largest facets lie in the middle of the icosahedron's faces. There an edge of 1.0515 is divided
  // into f parts and stretched from 0.7947 to 1. A triangle of edge e has the depth e^2 / 6, which gives
  // 0.2918 / f^2.
  const double estimate = std::sqrt(0.2918 / wanted);
  check_facets(20 * estimate * estimate, chord_error_m, place);
  int parts = std::max(1, static_cast<int>(0.9 * estimate));
  while (Geodesic(parts).chord_error() > wanted) ++parts;
  const Geodesic geodesic(parts);
  return geodesic.facets(sphere.radius_m * std::sqrt(4 * std::numbers::pi / geodesic.area()));
}

ComponentMesh cylinder_facets(const CylinderPrimitive& cylinder, double chord_error_m,
                              const SourcePlace& place) {
  return cone_facets({cylinder.radius_m, cylinder.radius_m, cylinder.height_m}, chord_error_m, place);
}

ComponentMesh cone_facets(const ConePrimitive& cone, double chord_error_m, const SourcePlace& place) {
  check_size(cone.radius_m, "radius_m", place);
  check_size(cone.height_m, "height_m", place);
  check_size(chord_error_m, "chord_error_m", place);
  const bool pointed = cone.top_radius_m == 0;
  if (!pointed) check_size(cone.top_radius_m, "top_radius_m", place);
  const double sides = polygon_sides(std::max(cone.radius_m, cone.top_radius_m), chord_error_m);
  check_facets(4 * sides, chord_error_m, place);

  // Points: centre of the base, centre of the top (or the tip), ring of the base, ring of the top.
  const auto n = static_cast<std::uint32_t>(sides);
  const double wider = widening(cone, sides);
  ComponentMesh mesh;
  mesh.points_m = {{0, 0, -cone.height_m / 2}, {0, 0, cone.height_m / 2}};
  for (const int ring : {0, 1}) {
    if (ring == 1 && pointed) break;
    const double radius = wider * (ring == 0 ? cone.radius_m : cone.top_radius_m);
    for (std::uint32_t i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      mesh.points_m.emplace_back(radius * std::cos(angle), radius * std::sin(angle), mesh.points_m[ring].z);
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t base = 2 + i, base_next = 2 + (i + 1) % n;
    mesh.triangles.push_back({0, base_next, base});
    if (pointed) {
      mesh.triangles.push_back({base, base_next, 1});
      continue;
    }
    mesh.triangles.push_back({base, base_next, base_next + n});
    mesh.triangles.push_back({base, base_next + n, base + n});
    mesh.triangles.push_back({1, base + n, base_next + n});
  }
  return mesh;
}

ComponentMesh box_facets(const BoxPrimitive& box, const SourcePlace& place) {
  for (const double size : box.size_m) check_size(size, "size_m", place);
  ComponentMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {  // bits 0, 1, 2: at the upper end of x, y, z
    mesh.points_m.emplace_back((corner & 1 ? 0.5 : -0.5) * box.size_m[0],
                               (corner & 2 ? 0.5 : -0.5) * box.size_m[1],
                               (corner & 4 ? 0.5 : -0.5) * box.size_m[2]);
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

}  // namespace tubefoot
