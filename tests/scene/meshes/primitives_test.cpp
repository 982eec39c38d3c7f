// SPDX-License-Identifier: GPL-3.0-or-later
// Tests spheres, cylinders, cones and boxes of facets: closed surfaces with outward facets, volumes, and
// chord errors within their limit.

#include "scene/meshes/primitives.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <map>

#include "fixtures/world/mesh_sizes.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::area;
using test::volume;
using testing::HasSubstr;
using testing::ThrowsMessage;

const SourcePlace kPlace{"scene.toml", 4, 1};

// Expects a closed and consistently oriented surface: each directed edge occurs once, with its opposite. It
// is one body without handles: Euler's V - E + F = 2. No facet is without area.
void expect_closed(const ComponentMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    const auto& p = mesh.points_m;
    EXPECT_GT(glm::length(glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]])), 0.0);
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  EXPECT_EQ(mesh.points_m.size() + mesh.triangles.size() - edges.size() / 2, 2u);
}

// Largest |distance(point)| over a dense sampling of all facets.
double largest_deviation(const ComponentMesh& mesh, const std::function<double(glm::dvec3)>& distance) {
  constexpr int n = 24;
  double largest = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; i + j <= n; ++j) {
        const glm::dvec3 p = (double(i) * mesh.points_m[a] + double(j) * mesh.points_m[b] +
                              double(n - i - j) * mesh.points_m[c]) /
                             double(n);
        largest = std::max(largest, std::abs(distance(p)));
      }
    }
  }
  return largest;
}

TEST(Sphere, IsClosedAndKeepsTheChordErrorWithoutWaste) {
  for (double chord : {0.5, 0.1, 0.01, 0.0007}) {
    const ComponentMesh mesh = sphere_facets({2.0}, chord, kPlace);
    SCOPED_TRACE(testing::Message() << "chord error " << chord << ", facets " << mesh.triangles.size());
    expect_closed(mesh);
    EXPECT_NEAR(area(mesh), 16 * pi, 1e-11);
    for (const glm::dvec3& p : mesh.points_m)
      EXPECT_NEAR(glm::length(p), glm::length(mesh.points_m[0]), 1e-14);
    const double deviation = largest_deviation(mesh, [](glm::dvec3 p) { return glm::length(p) - 2.0; });
    EXPECT_LE(deviation, chord * (1 + 1e-9));
    if (chord <= 0.01) {
      EXPECT_GE(deviation, 0.45 * chord);
    }
  }
}

TEST(Sphere, VolumeConvergesAsTheChordErrorDoes) {
  const double exact = 4 * pi / 3 * 8;
  double last = exact;
  for (double chord : {0.1, 0.01, 0.001, 0.0001}) {
    const double missing = exact - volume(sphere_facets({2.0}, chord, kPlace));
    EXPECT_GT(missing, 0);               // of all bodies with this area the sphere has the largest volume
    EXPECT_LT(missing, 8 * pi * chord);  // a shell of half that thickness
    EXPECT_LT(missing, 0.2 * last);
    last = missing;
  }
}

TEST(Sphere, ALargeChordErrorGivesTheIcosahedron) {
  const ComponentMesh mesh = sphere_facets({1.0}, 0.3, kPlace);
  EXPECT_EQ(mesh.triangles.size(), 20u);
  EXPECT_EQ(mesh.points_m.size(), 12u);
  const double edge = 1 / std::sin(2 * pi / 5);  // of the icosahedron in the unit sphere
  const double inscribed = 5 * std::sqrt(3.0) * edge * edge, wider = std::sqrt(4 * pi / inscribed);
  EXPECT_NEAR(volume(mesh), 5 * (3 + std::sqrt(5.0)) / 12 * std::pow(wider * edge, 3), 1e-12);
}

TEST(Cylinder, IsAClosedPrismWithinTheChordError) {
  for (double chord : {0.2, 0.01, 0.0005}) {
    const ComponentMesh mesh = cylinder_facets({1.5, 4.0}, chord, kPlace);
    SCOPED_TRACE(testing::Message() << "chord error " << chord);
    expect_closed(mesh);
    const double n = static_cast<double>(mesh.triangles.size()) / 4;
    const double radius = 1.5 * pi / n / std::sin(pi / n);
    EXPECT_NEAR(volume(mesh), n / 2 * radius * radius * std::sin(2 * pi / n) * 4.0, 1e-11);
    EXPECT_NEAR(area(mesh, [](const glm::dvec3& p) { return std::abs(p.z) < 1.99; }), 2 * pi * 1.5 * 4,
                1e-10);
    EXPECT_LE(1.5 * (1 - std::cos(pi / n)), chord);
    if (n > 3) {
      EXPECT_GT(1.5 * (1 - std::cos(pi / (n - 1))), chord) << "one side less would do";
    }
    const double deviation = largest_deviation(mesh, [](glm::dvec3 p) {
      return std::min(1.5 - std::hypot(p.x, p.y), 2.0 - std::abs(p.z));  // to the wall or to a lid
    });
    EXPECT_LE(deviation, chord);
  }
}

TEST(Cone, PointedOrTruncatedIsClosedWithinTheChordError) {
  for (double top : {0.0, 0.4, 1.7}) {
    const ComponentMesh mesh = cone_facets({1.0, top, 2.0}, 0.005, kPlace);
    SCOPED_TRACE(testing::Message() << "top radius " << top);
    expect_closed(mesh);
    const double deviation = largest_deviation(mesh, [top](glm::dvec3 p) {
      const double wall =
          1 + (top - 1) * (p.z + 1) / 2 - std::hypot(p.x, p.y);  // horizontal: more than the distance
      return std::min(wall, 1.0 - std::abs(p.z));
    });
    EXPECT_LE(deviation, 0.005 * (1 + 1e-9));
    const double exact = pi * 2.0 / 3 * (1 + top + top * top);
    EXPECT_NEAR(volume(mesh), exact, 0.02 * exact);
    const double side = pi * (1 + top) * std::hypot(2.0, 1 - top);
    EXPECT_NEAR(area(mesh, [](const glm::dvec3& p) { return std::abs(p.z) < 0.99; }), side, 1e-11);
  }
}

TEST(Cone, StandsOnItsBase) {
  const ComponentMesh mesh = cone_facets({1.0, 0.0, 2.0}, 0.1, kPlace);
  const auto tip = std::max_element(mesh.points_m.begin(), mesh.points_m.end(),
                                    [](const glm::dvec3& a, const glm::dvec3& b) { return a.z < b.z; });
  EXPECT_EQ(*tip, glm::dvec3(0, 0, 1));
}

TEST(Box, IsExact) {
  const ComponentMesh mesh = box_facets({{2, 3, 5}}, kPlace);
  expect_closed(mesh);
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_DOUBLE_EQ(volume(mesh), 30);
}

TEST(Primitives, RefuseAbsurdChordErrorsAndSizes) {
  EXPECT_THAT([] { sphere_facets({1.0}, 1e-9, kPlace); },
              ThrowsMessage<InputError>(
                  testing::AllOf(HasSubstr("scene.toml:4:1"), HasSubstr("larger chord_error_m"))));
  EXPECT_THAT(
      [] {
        cylinder_facets({1.0, 1.0}, 1e-15, kPlace);
      },
      ThrowsMessage<InputError>(HasSubstr("facets")));
  EXPECT_THROW(sphere_facets({0.0}, 0.1, kPlace), InputError);
  EXPECT_THROW(sphere_facets({std::nan("")}, 0.1, kPlace), InputError);
  EXPECT_THROW(sphere_facets({1.0}, 0.0, kPlace), InputError);
  EXPECT_THROW(cone_facets({1.0, -0.1, 1.0}, 0.1, kPlace), InputError);
  EXPECT_THROW(cylinder_facets({1.0, std::numeric_limits<double>::infinity()}, 0.1, kPlace), InputError);
  EXPECT_THROW(box_facets({{1, 0, 1}}, kPlace), InputError);
}

}  // namespace
}  // namespace tubefoot
