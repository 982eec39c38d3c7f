// SPDX-License-Identifier: GPL-3.0-or-later
// Tests measures of polygons and footprints: solid angle, area, nearest slant range and centroid. The
// comparisons are closed forms (physics sheet 7.1) and sampled polygons.

#include "geometry/integrals/measure.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fixtures/geometry/plane_polygons.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::flat_seabed;
using test::on_plane;
using test::Polygon2;
using test::random_convex;
using test::random_plane;
using test::relative;

PlanarPolygon planar(const std::vector<glm::dvec3>& corners, const FacetPlane& plane) {
  PlanarPolygon polygon;
  polygon.assign(corners, plane, PlaneFrame(plane));
  return polygon;
}
PlanarPolygon planar(const Polygon2& polygon, const FacetPlane& plane) {
  return planar(on_plane(plane, polygon), plane);
}

/// Solid angle of a triangle in space, whose plane comes from the corners.
double triangle_solid_angle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  const glm::dvec3 away = glm::normalize(glm::cross(b - a, c - a));
  return solid_angle(planar(std::vector{a, b, c}, FacetPlane{-away, glm::dot(a, away)}));
}

TEST(SolidAngle, KnownTriangles) {
  EXPECT_LT(relative(triangle_solid_angle({1, 0, 0}, {0, 1, 0}, {0, 0, 1}), pi / 2), 1e-14);
  EXPECT_LT(relative(triangle_solid_angle({1, -1, -1}, {1, 1, -1}, {1, 1, 1}), pi / 3), 1e-14);
  EXPECT_NEAR(triangle_solid_angle({0, 0, 10}, {1, 0, 10}, {0, 1, 10}), 0.004975144902, 1e-12);
}

TEST(SolidAngle, RectangleAndPyramid) {
  const Polygon2 rectangle{{-1, -2}, {1, -2}, {1, 2}, {-1, 2}};
  EXPECT_NEAR(solid_angle(planar(rectangle, flat_seabed(3))), 0.705295355263, 1e-12);
  const double a = std::tan(14.5 * degree), b = std::tan(7 * degree);
  const Polygon2 pyramid{{-a, -b}, {a, -b}, {a, b}, {-a, b}};
  EXPECT_NEAR(solid_angle(planar(pyramid, flat_seabed(1))), 0.122073535208, 1e-12);
  // A polygon that covers nearly the whole half space.
  const double far = 1e8;
  EXPECT_NEAR(
      solid_angle(planar(Polygon2{{-far, -far}, {far, -far}, {far, far}, {-far, far}}, flat_seabed(1))),
      2 * pi, 1e-7);
}

TEST(SolidAngle, SmallGrazingPolygonsKeepTheirDigits) {
  // A strip of width 1 um, seen at 0.01 degrees from 100 m: area times sin(grazing) / r^2 to first order.
  const double d = 100 * std::sin(0.01 * degree), x = 100 * std::cos(0.01 * degree), w = 1e-6;
  const Polygon2 strip{{x - w / 2, -w / 2}, {x + w / 2, -w / 2}, {x + w / 2, w / 2}, {x - w / 2, w / 2}};
  EXPECT_LT(relative(solid_angle(planar(strip, flat_seabed(d))), w * w * d / 1e6), 1e-7);
  EXPECT_EQ(solid_angle(planar(strip, flat_seabed(0))), 0);
}

// Law M2.
TEST(SolidAngle, AddsUpUnderSplitting) {
  const unsigned seed = 20240607;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  for (int i = 0; i < 200; ++i) {
    const FacetPlane plane = random_plane(random, std::exp(std::uniform_real_distribution<>(-7, 3)(random)));
    const Polygon2 p = random_convex(random, {3, 1}, 4, 1);
    double sum = 0, area_sum = 0;
    glm::dvec2 mean(0);
    for (const glm::dvec2& q : p) mean += q / double(p.size());
    for (std::size_t k = 0; k < p.size(); ++k) {
      const PlanarPolygon part = planar(Polygon2{mean, p[k], p[(k + 1) % p.size()]}, plane);
      sum += solid_angle(part);
      area_sum += area(part);
    }
    EXPECT_NEAR(solid_angle(planar(p, plane)), sum, 1e-13);
    EXPECT_NEAR(area(planar(p, plane)), area_sum, 1e-13);
  }
}

// Footprints of a tube on a flat seabed (physics sheet 7.1).
TEST(Area, AzimuthByGrazingTube) {
  const double h = 10, near = h / std::tan(25 * degree), far = h / std::tan(20 * degree), f = 1.5 * degree;
  const Polygon2 straight{
      {near, 0}, {far, 0}, {far * std::cos(f), far * std::sin(f)}, {near * std::cos(f), near * std::sin(f)}};
  EXPECT_NEAR(area(planar(straight, flat_seabed(h))), 3.860736328, 1e-9);
  Polygon2 arcs;  // the azimuth-by-grazing tube itself, with arcs in many chords
  const int chords = 4000;
  for (int i = 0; i <= chords; ++i) {
    const double t = f * i / chords;
    arcs.push_back(far * glm::dvec2(std::cos(t), std::sin(t)));
  }
  for (int i = chords; i >= 0; --i) {
    const double t = f * i / chords;
    arcs.push_back(near * glm::dvec2(std::cos(t), std::sin(t)));
  }
  EXPECT_NEAR(area(planar(arcs, flat_seabed(h))), 3.861177381, 1e-9);
}

TEST(Area, RectangularPyramid) {
  // The four corner rays of a pyramid of half-angles 0.15 and 7 degrees, axis 30 degrees down, sonar at 5
  // m.
  const double a = std::tan(0.15 * degree), b = std::tan(7 * degree), t = 30 * degree, h = 5;
  const glm::dvec3 axis(std::cos(t), 0, -std::sin(t)), side(0, 1, 0), up(std::sin(t), 0, std::cos(t));
  std::vector<glm::dvec3> corners;
  for (const auto& [s, e] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    const glm::dvec3 ray = axis + s * a * side + e * b * up;
    corners.push_back(ray * (-h / ray.z));
  }
  const PlanarPolygon polygon = planar(corners, flat_seabed(h));
  EXPECT_NEAR(std::abs(area(polygon)), 0.28210069162, 1e-11);
  EXPECT_NEAR(corners[0].x, 6.635224108, 1e-9);
  EXPECT_NEAR(corners[2].x, 11.779261829, 1e-9);
  EXPECT_NEAR(std::abs(solid_angle(polygon)), 4 * std::asin(std::sin(0.15 * degree) * std::sin(7 * degree)),
              1e-15);
}

// Law M1.
TEST(Area, TheOtherTurnIsNegative) {
  const Polygon2 p{{1, 0}, {1, 1}, {0, 0}};
  EXPECT_DOUBLE_EQ(area(planar(p, flat_seabed(2))), 0.5);
  EXPECT_DOUBLE_EQ(area(planar(Polygon2{p[2], p[1], p[0]}, flat_seabed(2))), -0.5);
}

TEST(Area, SquareMillimetreAtAHundredMetres) {
  const FacetPlane plane = flat_seabed(64);
  // Binary fractions, so that the corners themselves are exact.
  const double w = 1.0 / 1024;
  const std::vector<glm::dvec3> corners{
      {77, 13, -64}, {77, 13 + w, -64}, {77 + w, 13 + w, -64}, {77 + w, 13, -64}};
  EXPECT_LT(relative(std::abs(area(planar(corners, plane))), w * w), 1e-15);
}

TEST(SlantRange, NearestPointIsFootEdgeOrCorner) {
  const FacetPlane plane = flat_seabed(3);
  const Polygon2 square{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  EXPECT_DOUBLE_EQ(nearest_point(planar(square, plane)).range, 3);
  EXPECT_DOUBLE_EQ(farthest_range(planar(square, plane)), std::sqrt(11));
  const PlanarPolygon beside = planar(test::shifted(square, {5, 0.5}), plane);
  EXPECT_DOUBLE_EQ(nearest_point(beside).range, 5);  // the edge x = 4, at y = 0
  const PlanarPolygon oblique = planar(test::shifted(square, {5, 5}), plane);
  EXPECT_DOUBLE_EQ(nearest_point(oblique).range, std::sqrt(9 + 32));
  // foot point on an edge
  EXPECT_DOUBLE_EQ(nearest_point(planar(test::shifted(square, {1, 0}), plane)).range, 3);
  // foot point at a corner
  EXPECT_DOUBLE_EQ(nearest_point(planar(test::shifted(square, {1, 1}), plane)).range, 3);
}

TEST(SlantRange, NearestPointMayLieCloseToEitherEndOfAnEdge) {
  for (const double from : {-99.5, -0.5}) {
    const Polygon2 strip{{from, 1}, {from + 100, 1}, {from + 100, 2}, {from, 2}};
    EXPECT_NEAR(nearest_point(planar(strip, flat_seabed(3))).range, std::sqrt(10), 1e-13) << from;
  }
}

TEST(SlantRange, SliverThatPointsAtTheFootIsNotAtTheFoot) {
  for (const double turn : {0.0, 0.3, pi / 2, 2.0, pi, 4.0}) {
    const glm::dvec2 along(std::cos(turn), std::sin(turn)), across(-along.y, along.x);
    const Polygon2 sliver{10.0 * along, 20.0 * along - 1e-15 * across, 20.0 * along + 1e-15 * across};
    EXPECT_NEAR(nearest_point(planar(sliver, flat_seabed(3))).range, std::sqrt(109), 1e-12) << turn;
  }
}

TEST(SlantRange, AgreesWithSampledPolygons) {
  const unsigned seed = 7;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-3, 3), unit(0, 1);
  for (int i = 0; i < 100; ++i) {
    const FacetPlane plane = random_plane(random, 1);
    const Polygon2 p = random_convex(random, {place(random), place(random)}, 2, 1);
    const auto corners = on_plane(plane, p);
    const PlanarPolygon polygon = planar(corners, plane);
    const double near = nearest_point(polygon).range, far = farthest_range(polygon);
    double sampled = 1e9;
    for (int s = 0; s < 4000; ++s) {
      glm::dvec3 sum(0);
      double total = 0;
      for (const glm::dvec3& c : corners) {
        const double weight = std::pow(unit(random), 4);
        sum += weight * c;
        total += weight;
      }
      const double r = glm::length(sum / total);
      ASSERT_GE(r, near * (1 - 1e-14));
      ASSERT_LE(r, far * (1 + 1e-14));
      sampled = std::min(sampled, r);
    }
    EXPECT_LT(sampled - near, 0.5);
  }
}

// Law M3.
TEST(Centroid, StaysInsideWhereTheAreaIsLost) {
  const FacetPlane plane = flat_seabed(10);
  const glm::dvec2 c = centroid_offset(planar(Polygon2{{5, 5}, {6, 6}, {7, 7}}, plane));
  EXPECT_NEAR(glm::length(c - glm::dvec2(1, 1)), 0, 1e-6);
}

TEST(Centroid, OfASliverLiesAmongItsCorners) {
  // Rounding makes the second triangle of the fan negative. Without a limit, both nearly cancel.
  PlanarPolygon sliver;
  sliver.distance = 1;
  sliver.offsets = {{0, 0}, {1, 0}, {2, 1e-17}, {0.01, -0.49e-17}};
  EXPECT_GE(centroid_offset(sliver).x, 0);
  EXPECT_LE(centroid_offset(sliver).x, 2);
}

FootprintSet one_footprint(const FacetPlane& plane, const std::vector<Polygon2>& pieces) {
  FootprintSet set;
  Footprint footprint;
  footprint.plane_normal = plane.normal;
  footprint.plane_distance_m = plane.distance_m;
  footprint.piece_count = std::uint32_t(pieces.size());
  for (const Polygon2& p : pieces) {
    set.pieces.push_back({std::uint32_t(set.corners_m.size()), std::uint32_t(p.size())});
    for (const glm::dvec3& corner : on_plane(plane, p)) set.corners_m.push_back(corner);
  }
  set.footprints.push_back(footprint);
  return set;
}

TEST(Measure, FootprintOfSeveralPiecesIsTheirUnion) {
  const unsigned seed = 11;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  for (int i = 0; i < 50; ++i) {
    const FacetPlane plane = random_plane(random, 2);
    const Polygon2 whole{{3, 0}, {7, 0}, {7, 2}, {3, 2}};
    FootprintSet one = one_footprint(plane, {whole});
    FootprintSet three = one_footprint(plane, {{{3, 0}, {7, 0}, {7, 1}, {3, 1}},
                                               {{3, 1}, {5, 1}, {5, 2}, {3, 2}},
                                               {{5, 1}, {7, 1}, {7, 2}, {5, 2}}});
    measure(one);
    measure(three);
    const Footprint &a = one.footprints[0], &b = three.footprints[0];
    EXPECT_NEAR(a.area_m2, 8, 1e-13);
    EXPECT_NEAR(b.area_m2, 8, 1e-13);
    EXPECT_NEAR(b.solid_angle_sr, a.solid_angle_sr, 1e-14);
    EXPECT_LT(glm::length(a.centroid_m - on_plane(plane, {{5, 1}})[0]), 1e-13);
    EXPECT_LT(glm::length(a.centroid_m - b.centroid_m), 1e-13);
    EXPECT_NEAR(a.grazing_angle_rad, std::atan2(2, std::sqrt(26)), 1e-14);
    EXPECT_NEAR(b.slant_range_min_m, std::sqrt(13), 1e-13);
    EXPECT_NEAR(b.slant_range_max_m, std::sqrt(4 + 49 + 4), 1e-13);
  }
}

TEST(Measure, PieceOfNegativeAreaDoesNotMoveTheCentroid) {
  const FacetPlane plane = flat_seabed(2);
  FootprintSet set = one_footprint(
      plane, {{{3, 0}, {7, 0}, {7, 1}, {3, 1}}, {{3, 5}, {3, 6}, {6.9, 6}, {6.9, 5}}});  // areas 4 and -3.9
  measure(set);
  EXPECT_NEAR(set.footprints[0].area_m2, 0.1, 1e-13);
  EXPECT_LT(glm::length(set.footprints[0].centroid_m - on_plane(plane, {{5, 0.5}})[0]), 1e-13);
}

TEST(Measure, FootprintWithoutPiecesOrAreaIsFinite) {
  FootprintSet set = one_footprint(flat_seabed(2), {});
  measure(set);
  EXPECT_EQ(set.footprints[0].area_m2, 0);
  EXPECT_EQ(set.footprints[0].slant_range_max_m, 0);
  set = one_footprint(flat_seabed(2), {{{1, 1}, {1, 1}, {1, 1}}});
  measure(set);
  EXPECT_EQ(set.footprints[0].area_m2, 0);
  EXPECT_EQ(set.footprints[0].solid_angle_sr, 0);
  EXPECT_NEAR(set.footprints[0].slant_range_min_m, std::sqrt(6), 1e-15);
  EXPECT_NEAR(glm::length(set.footprints[0].centroid_m), std::sqrt(6), 1e-15);
}

}  // namespace
}  // namespace tubefoot
