// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "fixtures/geometry/grid_scenes.hpp"
#include "geometry/arithmetic/arithmetic_double.hpp"
#include "geometry/arithmetic/arithmetic_fixed.hpp"
#include "geometry/arithmetic/wide_vector.hpp"

// Tests the laws of the only predicate, sign det(n1, n2, n3). All tiers of the arithmetic must agree with
// plain big integers.
namespace tubefoot {
namespace {

using namespace test;
using Big = boost::multiprecision::cpp_int;  // any size
using BigVec = std::array<Big, 3>;
using Fixed = FixedArithmetic;

constexpr std::int32_t largest = 1 << 30;

int sign_of(const Big& x) { return x.sign(); }

BigVec big(GridPoint p) { return {p.x, p.y, p.z}; }

BigVec cross_of(const BigVec& a, const BigVec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Big dot_of(const BigVec& a, const BigVec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Big det(const BigVec& a, const BigVec& b, const BigVec& c) { return dot_of(cross_of(a, b), c); }

/// Log-uniform magnitude of up to 30 bits with any sign. Zeros and the extremes are frequent.
std::int32_t coordinate(Random& random) {
  const std::int32_t kind = uniform(random, 0, 19);
  const std::int32_t sign = uniform(random, 0, 1) ? 1 : -1;
  if (kind == 0) return 0;
  if (kind == 1) return sign * largest;
  if (kind == 2) return sign * (largest - uniform(random, 0, 2));
  const std::int32_t top = 1 << uniform(random, 0, 30);
  return sign * uniform(random, top / 2, top);
}
GridPoint point(Random& random) { return {coordinate(random), coordinate(random), coordinate(random)}; }
GridPoint large_point(Random& random) {
  const auto any = [&] { return uniform(random, -largest, largest); };
  return {any(), any(), any()};
}

/// Returns a + s b if it fits the coordinates, else a.
GridPoint combined(GridPoint a, GridPoint b, int s) {
  const std::int64_t x = a.x + std::int64_t(s) * b.x, y = a.y + std::int64_t(s) * b.y,
                     z = a.z + std::int64_t(s) * b.z;
  if (std::max({std::abs(x), std::abs(y), std::abs(z)}) > largest) return a;
  return {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), static_cast<std::int32_t>(z)};
}

/// A plane through two points with its normal in big integers.
struct TestPlane {
  Fixed::Plane fixed;
  BigVec normal;
};

TestPlane through(GridPoint a, GridPoint b) {
  TestPlane plane;
  Fixed{}.through(plane.fixed, a, b);
  plane.normal = cross_of(big(a), big(b));
  return plane;
}

/// Three planes of one of these kinds: independent, through a common point, dependent, or with common
/// points among the pairs. The third plane of the dependent kind is in the pencil of the first two: its
/// normal is a combination of theirs. All kinds except the first contain zeros.
std::array<TestPlane, 3> three_planes(Random& random) {
  const GridPoint p = point(random), q = point(random), r = point(random), s = point(random);
  switch (uniform(random, 0, 5)) {
    case 0:  // all contain p
      return {through(p, q), through(r, p), through(p, s)};
    case 1:  // p x q, p x r and p x (q + k r): linearly dependent
      return {through(p, q), through(p, r), through(p, combined(q, r, uniform(random, -3, 3)))};
    case 2:  // nearly so
      return {through(p, q), through(p, r), through(combined(p, {1, 0, 0}, 1), combined(q, r, 1))};
    case 3:  // the three sides of one triangle
      return {through(p, q), through(q, r), through(r, p)};
    case 4:  // multiples of one plane
      return {through(p, q), through(p, combined(q, p, 1)), through(r, s)};
    default:
      return {through(p, q), through(r, s), through(point(random), point(random))};
  }
}

int side(const TestPlane& p, const TestPlane& q, const TestPlane& r, int sign = 1) {
  Fixed::Corner corner;
  Fixed{}.meet(corner, p.fixed, q.fixed, sign);
  const int decided = Fixed{}.side(corner, r.fixed);
  EXPECT_EQ(decided, Fixed::exact_side(corner, r.fixed)) << "the filter and the integers differ";
  return decided;
}

// Laws A1, A2, A3 and A4.
TEST(Arithmetic, SignsOfThreePlanesEqualBigIntegersAndObeyTheirLaws) {
  Random random(1);
  int zeros = 0;
  for (int k = 0; k < 60000; ++k) {
    SCOPED_TRACE(testing::Message() << "seed 1, case " << k);
    const auto [p, q, r] = three_planes(random);
    const int expected = sign_of(det(p.normal, q.normal, r.normal));
    zeros += expected == 0;
    EXPECT_EQ(side(p, q, r), expected);
    EXPECT_EQ(side(q, r, p), expected) << "cyclic";
    EXPECT_EQ(side(r, p, q), expected) << "cyclic";
    EXPECT_EQ(side(q, p, r), -expected) << "antisymmetric";
    EXPECT_EQ(side(p, r, q), -expected) << "antisymmetric";
    EXPECT_EQ(side(p, q, r, -1), -expected) << "sign of the corner";
    EXPECT_EQ(side(p, q, p), 0) << "on its own plane";
    EXPECT_EQ(side(p, q, q), 0) << "on its own plane";
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(zeros, 20000);
}

// Law A3.
TEST(Arithmetic, TurningAPlaneRoundTurnsTheSign) {
  Random random(2);
  for (int k = 0; k < 20000; ++k) {
    SCOPED_TRACE(testing::Message() << "seed 2, case " << k);
    const GridPoint a = point(random), b = point(random);
    const auto [p, q, r] = three_planes(random);
    const TestPlane forth = through(a, b), back = through(b, a);
    EXPECT_EQ(side(forth, q, r), -side(back, q, r));
    EXPECT_EQ(side(p, q, forth), -side(p, q, back));
    EXPECT_EQ(side(forth, back, r), 0);
    ASSERT_FALSE(HasFailure());
  }
}

// Law A5.
TEST(Arithmetic, SidesOfPointsEqualBigIntegers) {
  Random random(3);
  int zeros = 0;
  for (int k = 0; k < 60000; ++k) {
    SCOPED_TRACE(testing::Message() << "seed 3, case " << k);
    const GridPoint a = point(random), b = point(random);
    const GridPoint d = k % 2 ? combined(a, b, uniform(random, -3, 3)) : point(random);
    const TestPlane plane = through(a, b);
    const int expected = sign_of(dot_of(big(d), plane.normal));
    zeros += expected == 0;
    Fixed::Corner corner;
    Fixed{}.point(corner, d);
    EXPECT_EQ(Fixed{}.side(d, plane.fixed), expected);
    EXPECT_EQ(Fixed::exact_side(d, plane.fixed), expected);
    EXPECT_EQ(Fixed{}.side(corner, plane.fixed), expected);
    EXPECT_EQ(Fixed{}.side(a, plane.fixed), 0);
    EXPECT_EQ(Fixed{}.side(b, plane.fixed), 0);
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(zeros, 20000);
}

/// Facets about an apex at the origin, in the representation of the kernel and in big integers.
struct TestFacets {
  FacetMesh mesh;
  std::array<FacetCone, 3> cones;
  std::array<Fixed::Facet, 3> fixed;
  std::array<BigVec, 3> n;
  std::array<Big, 3> c;

  /// Returns false if not all facets face the apex.
  bool make(const std::array<std::array<GridPoint, 3>, 3>& points) {
    mesh = {};
    for (FacetId f = 0; f < 3; ++f) {
      std::array<VertexId, 3> v{};
      for (int k = 0; k < 3; ++k) v[k] = add_vertex(mesh, points[f][k]);
      add_facet(mesh, v[0], v[1], v[2]);
      if (!FacetCone::make(mesh, f, {0, 0, 0}, cones[f])) return false;
      BigVec e[2];
      for (int edge = 0; edge < 2; ++edge)
        for (int x = 0; x < 3; ++x) e[edge][x] = big(points[f][edge + 1])[x] - big(points[f][0])[x];
      n[f] = cross_of(e[0], e[1]);
      c[f] = dot_of(n[f], big(points[f][0]));
      if (c[f] < 0) {
        c[f] = -c[f];
        for (Big& x : n[f]) x = -x;
      }
    }
    for (int f = 0; f < 3; ++f) Fixed{}.facet(fixed[f], cones[f]);
    return true;
  }

  TestPlane depth(int i, int j) const {
    TestPlane plane;
    Fixed{}.depth(plane.fixed, fixed[i], fixed[j]);
    for (int k = 0; k < 3; ++k) plane.normal[k] = c[i] * n[j][k] - c[j] * n[i][k];
    return plane;
  }
};

TestFacets random_facets(Random& random) {
  TestFacets facets;
  for (;;) {
    std::array<std::array<GridPoint, 3>, 3> points;
    const bool large = uniform(random, 0, 1) != 0;
    for (auto& facet : points)
      for (GridPoint& p : facet) p = large ? large_point(random) : point(random);
    // common vertices: for a common edge, the depth plane is the plane of the edge
    const int shared = uniform(random, 0, 3);
    for (int k = 0; k < shared && k < 2; ++k) points[1][k] = points[0][k];
    if (shared == 3) points[2][2] = points[1][1] = points[0][0];
    if (facets.make(points)) return facets;
  }
}

// Laws A6 and F1.
TEST(Arithmetic, FacetPlanesAreExactAndFaceTheApex) {
  Random random(4);
  for (int k = 0; k < 20000; ++k) {
    SCOPED_TRACE(testing::Message() << "seed 4, case " << k);
    const TestFacets facets = random_facets(random);
    for (int f = 0; f < 3; ++f) {
      const FacetCone& cone = facets.cones[f];
      EXPECT_EQ(Big(cone.normal.x), facets.n[f][0]);
      EXPECT_EQ(Big(cone.normal.y), facets.n[f][1]);
      EXPECT_EQ(Big(cone.normal.z), facets.n[f][2]);
      EXPECT_EQ(Big(cone.offset), facets.c[f]);
      EXPECT_GT(det(big(cone.point[0]), big(cone.point[1]), big(cone.point[2])), 0);
      for (const GridPoint& p : facets.mesh.vertices) {
        const int expected = sign_of(facets.c[f] - dot_of(facets.n[f], big(p)));
        EXPECT_EQ(Fixed{}.nearer(facets.fixed[f], p), expected);
      }
      for (const GridPoint& p : cone.point) EXPECT_EQ(Fixed{}.nearer(facets.fixed[f], p), 0);
    }
    ASSERT_FALSE(HasFailure());
  }
}

// Law A7.
TEST(Arithmetic, DepthPlanesObeyTheirIdentities) {
  Random random(5);
  for (int k = 0; k < 6000; ++k) {
    SCOPED_TRACE(testing::Message() << "seed 5, case " << k);
    const TestFacets facets = random_facets(random);
    const TestPlane ij = facets.depth(0, 1), ji = facets.depth(1, 0), jk = facets.depth(1, 2),
                    ki = facets.depth(2, 0), ik = facets.depth(0, 2);
    const TestPlane any = through(point(random), point(random)),
                    other = through(point(random), point(random));
    for (const GridPoint& p : facets.mesh.vertices) {
      const int s = Fixed{}.side(p, ij.fixed);
      EXPECT_EQ(s, sign_of(dot_of(big(p), ij.normal)));
      EXPECT_EQ(s, Fixed::exact_side(p, ij.fixed));
      EXPECT_EQ(Fixed{}.side(p, ji.fixed), -s) << "m_ji = -m_ij";
    }
    // Off the depth plane of i and j, if a vertex of i lies beyond the plane of j, then j is nearer.
    for (const GridPoint& p : facets.cones[0].point) {
      if (dot_of(facets.n[1], big(p)) <= 0) continue;
      EXPECT_EQ(Fixed{}.side(p, ij.fixed), -Fixed{}.nearer(facets.fixed[1], p));
      for (const GridPoint& q : facets.cones[1].point)
        if (p == q) {
          EXPECT_EQ(Fixed{}.side(p, ij.fixed), 0) << "a shared vertex";
        }
    }
    EXPECT_EQ(side(ij, jk, ki), 0) << "three facets meet along one direction";
    EXPECT_EQ(side(ij, ik, jk), 0);
    EXPECT_EQ(side(ij, ji, any), 0);
    for (const auto& [p, q, r] : {std::array{ij, any, other}, {any, ij, ik}, {ij, ik, any}, {ij, jk, ij}})
      EXPECT_EQ(side(p, q, r), sign_of(det(p.normal, q.normal, r.normal)));
    ASSERT_FALSE(HasFailure());
  }
}

// Law A10.
TEST(Arithmetic, ExtremesFitTheBitBudget) {
  // All corners of the coordinate cube: normals, offsets and determinants attain their maxima.
  std::vector<GridPoint> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back({k & 1 ? largest : -largest, k & 2 ? largest : -largest, k & 4 ? largest : -largest});
  std::vector<TestPlane> planes;
  for (const GridPoint& a : corners)
    for (const GridPoint& b : corners)
      if (cross_of(big(a), big(b)) != BigVec{}) planes.push_back(through(a, b));
  for (const TestPlane& p : planes)
    for (const TestPlane& q : planes)
      for (const TestPlane& r : planes) ASSERT_EQ(side(p, q, r), sign_of(det(p.normal, q.normal, r.normal)));

  Random random(6);
  const auto corner = [&] { return corners[random() % 8]; };
  for (int k = 0; k < 4000; ++k) {
    SCOPED_TRACE(testing::Message() << "seed 6, case " << k);
    TestFacets facets;
    std::array<std::array<GridPoint, 3>, 3> points;
    for (auto& facet : points)
      for (GridPoint& p : facet) p = corner();
    if (!facets.make(points)) continue;
    const std::array planes_of{facets.depth(0, 1), facets.depth(0, 2), facets.depth(1, 2)};
    const TestPlane any = planes[random() % planes.size()];
    EXPECT_EQ(side(planes_of[0], planes_of[1], planes_of[2]), 0);
    EXPECT_EQ(side(planes_of[0], planes_of[1], any),
              sign_of(det(planes_of[0].normal, planes_of[1].normal, any.normal)));
    ASSERT_FALSE(HasFailure());
  }
}

// ---- Tiers

/// Returns whether the double before the integers decides.
bool decided_by_double(const TestPlane& p, const TestPlane& q, const TestPlane& r) {
  Fixed::Corner c;
  Fixed{}.meet(c, p.fixed, q.fixed, 1);
  return Fixed{}.double_side(c, r.fixed) != 0;
}

TEST(Arithmetic, DoubleDecidesNearlyAllRandomSignsAndNoPlantedZero) {
  Random random(7);
  constexpr int cases = 50000;
  int decided = 0, deep = 0;
  for (int k = 0; k < cases; ++k) {
    const auto any = [&] { return through(large_point(random), large_point(random)); };
    decided += decided_by_double(any(), any(), any());
    const TestFacets facets = [&] {
      for (TestFacets f;;)
        if (f.make({{{large_point(random), large_point(random), large_point(random)},
                     {large_point(random), large_point(random), large_point(random)},
                     {large_point(random), large_point(random), large_point(random)}}}))
          return f;
    }();
    if (k % 10 == 0) deep += decided_by_double(facets.depth(0, 1), facets.depth(0, 2), any());
    const GridPoint p = large_point(random);
    ASSERT_FALSE(decided_by_double(through(p, large_point(random)), through(p, large_point(random)),
                                   through(p, large_point(random))))
        << "a true zero, seed 7, case " << k;
  }
  EXPECT_GT(decided, cases * 0.9999);
  EXPECT_GT(deep, cases / 10 * 0.999);
}

// Law A9.
TEST(Arithmetic, ErrorBoundsHold) {
  Random random(8);
  for (int k = 0; k < 20000; ++k) {
    SCOPED_TRACE(testing::Message() << "seed 8, case " << k);
    const TestFacets facets = random_facets(random);
    const auto plane = [&] {
      return uniform(random, 0, 2) ? through(point(random), point(random)) : facets.depth(0, 1);
    };
    const TestPlane p = plane(), q = plane();
    // All these doubles are (rounded) integers, so that errors can be compared exactly. Bounds are rounded
    // up.
    const auto error_of = [](double approximate, const Big& exact) -> Big {
      return abs(Big(approximate) - exact);
    };
    const auto at_least = [](double bound) -> Big { return Big(bound) + 1; };
    Fixed::Corner c;
    Fixed{}.meet(c, p.fixed, q.fixed, 1);
    const BigVec v = cross_of(p.normal, q.normal);
    for (int x = 0; x < 3; ++x) {
      EXPECT_LE(error_of(p.fixed.n[x], p.normal[x]), at_least(p.fixed.error));
      EXPECT_LE(abs(p.normal[x]), at_least(p.fixed.size * (1 + 4 * Fixed::u)));
      EXPECT_LE(error_of(c.v[x], v[x]), at_least(c.error));
      EXPECT_LE(abs(v[x]), at_least(c.size * (1 + 4 * Fixed::u)));
    }
    ASSERT_FALSE(HasFailure());
  }
}

// Law A9.
TEST(Arithmetic, FourHalfSpacesAtOnceSayWhatEachSays) {
  Random random(10);
  const Fixed kernel;
  std::size_t sure = 0, in_ambiguity = 0;
  for (int k = 0; k < 20000; ++k) {
    SCOPED_TRACE(testing::Message() << "seed 10, case " << k);
    const TestFacets facets = random_facets(random);
    const std::array three = three_planes(random);
    const std::array<Fixed::Plane, 4> planes{three[0].fixed, three[1].fixed, three[2].fixed,
                                             facets.depth(0, 1).fixed};
    std::array<int, 4> turned{};
    const auto count = static_cast<std::size_t>(uniform(random, 0, 4));
    Fixed::FourHalves halves;
    for (std::size_t h = 0; h < count; ++h) {
      turned[h] = uniform(random, 0, 1) ? 1 : -1;
      halves.set(h, planes[h], turned[h]);
    }
    const auto sign_in = [](unsigned sides, std::size_t h) {
      return int(sides >> h & 1u) - int(sides >> (h + 4) & 1u);
    };
    std::array<Fixed::Corner, 2> corners;
    const GridPoint p = point(random);
    kernel.meet(corners[0], planes[0], planes[1], uniform(random, 0, 1) ? 1 : -1);
    kernel.point(corners[1], p);
    for (const Fixed::Corner& corner : corners)
      for (std::size_t h = 0; h < 4; ++h) {
        const int single = turned[h] * kernel.double_side(corner, planes[h]);
        EXPECT_EQ(sign_in(kernel.double_sides(corner, halves), h), single);
        if (h < count) ++(single != 0 ? sure : in_ambiguity);
      }
    EXPECT_EQ(kernel.double_sides(p, halves), kernel.double_sides(corners[1], halves));
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(sure, 10000u);
  EXPECT_GT(in_ambiguity, 10000u);
}

TEST(Arithmetic, PlainDoubleIsWrongOnPlantedZerosWhereFixedIsRight) {
  Random random(9);
  constexpr int cases = 2000;
  int wrong = 0;
  const DoubleArithmetic plain{0};
  for (int k = 0; k < cases; ++k) {
    const GridPoint a = large_point(random);
    const std::array other{large_point(random), large_point(random), large_point(random)};
    std::array<DoubleArithmetic::Plane, 3> planes;
    std::array<TestPlane, 3> exact;
    for (int x = 0; x < 3; ++x) {
      plain.through(planes[x], a, other[x]);
      exact[x] = through(a, other[x]);
    }
    DoubleArithmetic::Corner corner;
    plain.meet(corner, planes[0], planes[1], 1);
    wrong += plain.side(corner, planes[2]) != 0;
    EXPECT_EQ(side(exact[0], exact[1], exact[2]), 0);
    // A large tolerance decides these zeros, which is its only merit.
    EXPECT_EQ(DoubleArithmetic{1e-9}.side(corner, planes[2]), 0);
  }
  EXPECT_GT(wrong, cases / 2);
}

}  // namespace
}  // namespace tubefoot
