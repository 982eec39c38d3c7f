// SPDX-License-Identifier: GPL-3.0-or-later
// Tests polygons of mesh files that are cut into triangles: areas by the shoelace formula, and invalid
// polygons.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <numbers>
#include <random>

#include "fixtures/processor_time.hpp"
#include "fixtures/world/mesh_sizes.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "scene/meshes/mesh_file.hpp"

namespace tubefoot {
namespace {

using test::area;
using test::read;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::ThrowsMessage;

using Outline = std::vector<glm::dvec2>;

double shoelace(const Outline& outline) {
  double twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const glm::dvec2 a = outline[i], b = outline[(i + 1) % outline.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return twice / 2;
}

std::string obj_of(const std::vector<glm::dvec3>& points, const std::string& faces) {
  std::string text;
  for (const glm::dvec3& p : points) text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
  return text + faces;
}

std::string one_face(std::size_t corners) {
  std::string face = "f";
  for (std::size_t i = 0; i < corners; ++i) face += fmt::format(" {}", i + 1);
  return face + "\n";
}

// An upright slab with two legs, 3 m wide, 2 m high, legs of 1 m: 4.4 m2 in front.
const Outline u_shape{{0, 0}, {1, 0}, {1, 1.2}, {1.8, 1.2}, {1.8, 0}, {2.8, 0}, {2.8, 2}, {0, 2}};

/// The prism over an outline: two caps of many corners and one quadrangle per side.
std::vector<glm::dvec3> prism_points(const Outline& outline, double height) {
  std::vector<glm::dvec3> points;
  for (const double z : {0.0, height})
    for (const glm::dvec2 p : outline) points.emplace_back(p, z);
  return points;
}
std::vector<std::vector<std::size_t>> prism_faces(const Outline& outline) {
  const std::size_t n = outline.size();
  std::vector<std::vector<std::size_t>> faces(2);
  for (std::size_t i = 0; i < n; ++i) {
    faces[0].push_back(n - 1 - i);
    faces[1].push_back(n + i);
    faces.push_back({i, (i + 1) % n, n + (i + 1) % n, n + i});
  }
  return faces;
}
double prism_area(const Outline& outline, double height) {
  double around = 0;
  for (std::size_t i = 0; i < outline.size(); ++i)
    around += glm::distance(outline[i], outline[(i + 1) % outline.size()]);
  return 2 * shoelace(outline) + around * height;
}

TEST(MeshPolygons, AUShapedPrismHasItsOwnAreaInEveryFormat) {
  const double height = 0.5;
  const auto points = prism_points(u_shape, height);
  const auto faces = prism_faces(u_shape);
  std::string obj = obj_of(points, ""), off = fmt::format("OFF\n{} {} 0\n", points.size(), faces.size()),
              ply = fmt::format(
                  "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double "
                  "y\nproperty double z\nelement face {}\nproperty list uchar int "
                  "vertex_indices\nend_header\n",
                  points.size(), faces.size());
  for (const glm::dvec3& p : points) {
    const std::string line = fmt::format("{} {} {}\n", p.x, p.y, p.z);
    off += line;
    ply += line;
  }
  for (const auto& face : faces) {
    std::string from_one, from_zero;
    for (const std::size_t corner : face) {
      from_one += fmt::format(" {}", corner + 1);
      from_zero += fmt::format(" {}", corner);
    }
    obj += "f" + from_one + "\n";
    off += fmt::format("{}{}\n", face.size(), from_zero);
    ply += fmt::format("{}{}\n", face.size(), from_zero);
  }
  const double expected = prism_area(u_shape, height);
  for (const auto& [name, text] :
       {std::pair("u.obj", obj), std::pair("u.off", off), std::pair("u.ply", ply)}) {
    const NamedMesh mesh = read(name, text);
    EXPECT_NEAR(area(mesh), expected, 1e-12) << name;
    EXPECT_THAT(mesh.triangles, SizeIs(2 * 6 + 8 * 2)) << name;
    EXPECT_THAT(mesh.warnings, IsEmpty()) << name;
    // Closed: each edge occurs in both directions.
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) {
        ++edges[{t[k], t[(k + 1) % 3]}];
        --edges[{t[(k + 1) % 3], t[k]}];
      }
    for (const auto& [edge, surplus] : edges) EXPECT_EQ(surplus, 0) << name;
  }
}

TEST(MeshPolygons, AnyOutlineTurnedInSpaceKeepsAreaSideAndCorners) {
  constexpr unsigned seed = 20261;
  RecordProperty("seed", seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(fmt::format("seed {}, trial {}", seed, trial));
    // Corners around a middle at increasing angles: simple, with random radii.
    Outline outline;
    const int corners = 4 + static_cast<int>(random() % 40);
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * std::numbers::pi * (i + 0.8 * unit(random)) / corners,
                   radius = 0.1 + unit(random) * unit(random);
      outline.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    const glm::dquat turn = glm::normalize(
        glm::dquat(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5));
    std::vector<glm::dvec3> points;
    for (const glm::dvec2 p : outline) points.push_back(turn * glm::dvec3(p, 0) + glm::dvec3(3, -2, 5));
    const NamedMesh mesh = read("m.obj", obj_of(points, one_face(points.size())));
    EXPECT_NEAR(area(mesh), shoelace(outline), 1e-12);
    EXPECT_THAT(mesh.triangles, SizeIs(outline.size() - 2));
    EXPECT_THAT(mesh.points_m, SizeIs(outline.size()));
    const glm::dvec3 side = turn * glm::dvec3(0, 0, 1);
    for (const auto& [a, b, c] : mesh.triangles)
      EXPECT_GT(glm::dot(side, glm::cross(mesh.points_m[b] - mesh.points_m[a],
                                          mesh.points_m[c] - mesh.points_m[a])),
                0);
  }
}

TEST(MeshPolygons, CornersOnALineWithTheirNeighboursStay) {
  // A square with a corner in the middle of each side, and two on one side: adjacent facets may end there.
  const Outline square{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1.5}, {3, 3}, {1, 3}, {0, 3}, {0, 2}};
  std::vector<glm::dvec3> points;
  for (const glm::dvec2 p : square) points.emplace_back(p, 0);
  const NamedMesh mesh = read("m.obj", obj_of(points, one_face(points.size())));
  EXPECT_DOUBLE_EQ(area(mesh), 9);
  EXPECT_THAT(mesh.triangles, SizeIs(7));
  for (const auto& [a, b, c] : mesh.triangles)
    EXPECT_GT(
        glm::length(glm::cross(mesh.points_m[b] - mesh.points_m[a], mesh.points_m[c] - mesh.points_m[a])),
        0.1);
}

TEST(MeshPolygons, AHoleOnABridgeIsAHole) {
  // A square of 4 x 4 with a hole of 1 x 1, which an edge in both directions connects to a corner. The
  // second case connects the hole to the middle of a side.
  const std::string corners =
      "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 2 0\nv 2 2 0\nv 2 1 0\nv 1 0 0\n";
  EXPECT_DOUBLE_EQ(area(read("m.obj", corners + "f 1 2 3 4 1 5 6 7 8 5\n")), 15);
  EXPECT_DOUBLE_EQ(area(read("m.obj", corners + "f 1 9 5 6 7 8 5 9 2 3 4\n")), 15);
  // Separate corners instead of repeated ones.
  EXPECT_DOUBLE_EQ(area(read("m.obj", corners + "v 1 1 0\nv 0 0 0\nf 1 2 3 4 11 5 6 7 8 10\n")), 15);
}

TEST(MeshPolygons, WhatCrossesItselfIsRefusedAtItsLine) {
  const std::string square = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 0 2 0\n";
  const auto refuses = [&](const std::string& faces) {
    const TestFolder folder;
    const auto file = folder.write("m.obj", square + faces);
    EXPECT_THAT(
        [&] { read_mesh_file(file); },
        ThrowsMessage<InputError>(testing::AllOf(
            HasSubstr("m.obj:6: "), HasSubstr("corners crosses or overlaps itself"), HasSubstr("repair"))))
        << faces;
  };
  refuses("f 1 3 2 4\n");          // a bow tie
  refuses("f 1 3 2 5\n");          // one with unequal halves
  refuses("f 1 2 3 4 1 2 3 4\n");  // twice around
  const std::string star = "v 0 1 0\nv -0.6 -0.8 0\nv 1 0.3 0\nv -1 0.3 0\nv 0.6 -0.8 0\nf 1 2 3 4 5\n";
  EXPECT_THROW(read("m.obj", star), InputError);
}

TEST(MeshPolygons, WhatIsNotFlatIsReportedWithHowFar) {
  // A square with one corner 0.4 higher: the corners are about 0.1 off their plane.
  const NamedMesh mesh = read("m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0.4\nv 0 1 0\nf 1 2 3 4\n");
  EXPECT_THAT(mesh.triangles, SizeIs(2));
  EXPECT_THAT(mesh.warnings,
              ElementsAre(HasSubstr("1 polygons are not flat and are cut into triangles; the face of line 5 "
                                    "deviates most from its plane, by 0.0962")));
  // Rounding to single precision gives no warning.
  EXPECT_THAT(read("m.obj", "v 0 0 100\nv 1 0 100\nv 1 1 100.000004\nv 0 1 100\nf 1 2 3 4\n").warnings,
              IsEmpty());
}

TEST(MeshPolygons, WithoutAreaAPolygonStaysAsFacetsWithoutArea) {
  EXPECT_THAT(read("m.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nv 3 3 3\nv 0 1 0\nf 1 2 3 4\nf 1 2 5\n").triangles,
              SizeIs(3));
  // A quadrangle with a repeated corner is a triangle.
  const NamedMesh twice = read("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2 3\n");
  EXPECT_THAT(twice.triangles, SizeIs(1));
  EXPECT_DOUBLE_EQ(area(twice), 0.5);
}

TEST(MeshPolygons, ManyCornersTakeNoTimeToSpeakOf) {
  // A comb of 20 000 teeth: no corner sees the whole comb.
  constexpr int teeth = 20000;
  Outline comb{{0, 0}, {2 * teeth, 0}};
  for (int i = teeth; i-- > 0;) {
    comb.emplace_back(2 * i + 1, 3);
    comb.emplace_back(2 * i, 1);
  }
  std::vector<glm::dvec3> points;
  for (const glm::dvec2 p : comb) points.emplace_back(p, 0);
  const NamedMesh mesh = read("m.obj", obj_of(points, one_face(points.size())));
  EXPECT_NEAR(area(mesh), shoelace(comb), 1e-6);
}

// Teeth a thousand times as long as their distance, in an oblique plane.
TEST(MeshPolygons, LongTeethTakeNoTimeToSpeakOf) {
  for (const double lean : {0.0, 300.0}) {
    constexpr int teeth = 5000;
    Outline comb{{0, -1}, {2 * teeth, -1}};
    for (int i = teeth; i-- > 0;) {
      comb.emplace_back(2 * i + 1 + lean, 3000);
      comb.emplace_back(2 * i, 0);
    }
    std::vector<glm::dvec3> points;
    for (const glm::dvec2 p : comb) points.emplace_back(p, 0.25 * p.x);
    const std::string text = obj_of(points, one_face(points.size()));
    EXPECT_LT(processor_seconds([&] { EXPECT_EQ(read("m.obj", text).triangles.size(), points.size() - 2); }),
              hostile_input_s);
  }
}

}  // namespace
}  // namespace tubefoot
