// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <span>
#include <type_traits>

#include "fixtures/geometry/grid_scenes.hpp"
#include "geometry/arithmetic/arithmetic_filtered.hpp"
#include "geometry/arithmetic/arithmetic_fixed.hpp"
#include "geometry/arithmetic/arithmetic_rational.hpp"
#include "geometry/visibility/visibility_solver.hpp"
#include "prove/small_scenes.hpp"

// Tests which tier of the arithmetic decides. Names decide before any arithmetic, the double or the
// interval decides nearly always, and integers decide the rest. The test computes whole views with an
// arithmetic that counts its decisions.
namespace tubefoot {
namespace {

using namespace test;

struct Tiers {
  std::size_t first = 0;        ///< signs that the double or the interval decided
  std::size_t exact = 0;        ///< nonzero signs that needed integers
  std::size_t zero = 0;         ///< zeros, which only integers can decide
  std::size_t wide = 0;         ///< of the last two, those that involve a depth plane
  std::size_t same_planes = 0;  ///< a corner against one of its own planes: names should have decided this
  std::size_t all() const { return first + exact + zero; }
  void add(const Tiers& o) {
    first += o.first;
    exact += o.exact;
    zero += o.zero;
    wide += o.wide;
    same_planes += o.same_planes;
  }
};

/// One function per arithmetic: its first tier, on any of the three decisions.
int first_tier(const FixedArithmetic& a, const auto& what, const FixedArithmetic::Plane& plane) {
  return a.double_side(what, plane);
}
int first_tier(const FixedArithmetic& a, const FixedArithmetic::Facet& f, GridPoint p) {
  return a.double_nearer(f, p);
}
int first_tier(const FilteredArithmetic& a, const auto& what, const FilteredArithmetic::Plane& plane) {
  return a.interval_side(what, plane);
}
int first_tier(const FilteredArithmetic& a, const FilteredArithmetic::Facet& f, GridPoint p) {
  return a.interval_nearer(f, p);
}

/// The arithmetic itself, tier by tier, with a count of each.
template <class A>
struct Counting : A {
  Tiers* tiers = nullptr;

  int side(const typename A::Corner& corner, const typename A::Plane& plane) const {
    tiers->same_planes += corner.p == &plane || corner.q == &plane;
    const bool wide = plane.i || (corner.p && (corner.p->i || corner.q->i));
    if (const int s = first_tier(*this, corner, plane)) return decided(s);
    return settled(A::exact_side(corner, plane), wide);
  }
  int side(GridPoint p, const typename A::Plane& plane) const {
    if (const int s = first_tier(*this, p, plane)) return decided(s);
    return settled(A::exact_side(p, plane), plane.i != nullptr);
  }
  int nearer(const typename A::Facet& f, GridPoint p) const {
    if (const int s = first_tier(*this, f, p)) return decided(s);
    return settled(A::exact_nearer(f, p), false);
  }

  // The first tier by itself: the kernel repeats the ambiguous decisions, unless a name decides.
  int double_side(const typename A::Corner& corner,
                  const typename A::Plane& plane) const requires std::is_same_v<A, FixedArithmetic> {
    const int s = A::double_side(corner, plane);
    return s != 0 ? decided(s) : 0;
  }
  unsigned double_sides(const auto& what,
                        const auto& halves) const requires std::is_same_v<A, FixedArithmetic> {
    const unsigned sides = A::double_sides(what, halves);
    tiers->first += static_cast<unsigned>(std::popcount(sides));
    return sides;
  }

 private:
  int decided(int sign) const {
    ++tiers->first;
    return sign;
  }
  int settled(int sign, bool wide) const {
    ++(sign == 0 ? tiers->zero : tiers->exact);
    tiers->wide += wide;
    return sign;
  }
};

/// Counts the decisions for all tubes, including open water.
template <class A>
Tiers tiers_of(const FacetMesh& mesh, const TubeSet& tubes) {
  Tiers tiers;
  Counting<A> arithmetic;
  arithmetic.tiers = &tiers;
  VisibilitySolver<Counting<A>> solver;
  VisibilityOptions options;
  options.open_water = true;
  const SceneTree tree(mesh, SceneTree::HeightFieldSearch::ignored);
  CandidateFacets candidate_facets;
  TubeVisibility seen;
  for (std::uint32_t t = 0; t < tubes.tubes.size(); ++t) {
    const std::array<GridPoint, 4> rays = rays_of(tubes, t);
    const TubesInPyramid tube{rays, std::span(&rays, 1)};
    candidate_facets.gather(mesh, tree, tubes.apex, tubes.reach, rays, false);
    solver.begin(mesh, tubes.apex, candidate_facets);
    if constexpr (std::is_same_v<A, FilteredArithmetic>) {
      const FilteredArithmetic::Guard guard;
      solver.run(arithmetic, options, tube, std::span(&seen, 1));
    } else {
      solver.run(arithmetic, options, tube, std::span(&seen, 1));
    }
  }
  return tiers;
}

/// Facets in general position: no vertex is shared, no two are collinear.
Scene generic(std::uint64_t seed) {
  Random random(seed);
  return {"generic", make_random_triangles(random, 40, 1 << 27, 1 << 26),
          forward_tubes({uniform(random, -99999, 99999), 0, 0}, 2, 2, 40, 30)};
}

template <class A>
class TiersOf : public testing::Test {};
using BothArithmetics = testing::Types<FixedArithmetic, FilteredArithmetic>;
TYPED_TEST_SUITE(TiersOf, BothArithmetics);

TYPED_TEST(TiersOf, TheFirstDecidesEverythingInGeneralPosition) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Scene scene = generic(seed);
    const Tiers tiers = tiers_of<TypeParam>(scene.mesh, scene.tubes);
    EXPECT_GT(tiers.first, 3000u);

    EXPECT_EQ(tiers.exact, 0u) << "a sign that is not 0 needed integers";
    EXPECT_EQ(tiers.zero, 0u) << "a zero that names should have settled";
    EXPECT_EQ(tiers.same_planes, 0u);
  }
}

TYPED_TEST(TiersOf, NamesSettleTheZerosOfSharedVertices) {
  // The same terrain with shared vertices, and with a copy of each vertex per facet. Only in the second
  // case do the zeros of shared edges reach the arithmetic.
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const FacetMesh shared = rough_terrain(random, 8, 20000000, -3000000, 700000);
    const TubeSet tubes = forward_tubes({uniform(random, -999, 999), -77, 3}, 2, 1, 50, 30, 15);
    FacetMesh apart;
    for (const auto& v : shared.facets)
      add_facet(apart, add_vertex(apart, shared.vertices[v[0]]), add_vertex(apart, shared.vertices[v[1]]),
                add_vertex(apart, shared.vertices[v[2]]));
    const Tiers by_name = tiers_of<TypeParam>(shared, tubes), by_number = tiers_of<TypeParam>(apart, tubes);
    // A depth plane contains the vertices that its two facets share, but its name does not state this.
    EXPECT_EQ(by_name.zero, by_name.wide);
    EXPECT_LT(by_name.zero * 50, by_number.zero);
    EXPECT_EQ(by_name.exact, 0u);
    EXPECT_EQ(by_name.same_planes, 0u);
    EXPECT_GT(by_number.zero, 300u) << "what names settle above";
    EXPECT_LT(by_name.all(), by_number.all());
  }
}

// Law A8.
TYPED_TEST(TiersOf, IntegersSettleTheZerosThatNoNameTells) {
  // A ray through a vertex, walls through edges, coplanar facets: coincidences of numbers, not of names.
  Random random(5);
  FacetMesh plates;
  add_plate(plates, 12, 4, 4, true);
  add_plate(plates, 12, 3, 6, false);
  const Tiers flat = tiers_of<TypeParam>(plates, lattice_tubes({0, 0, 0}, -2, -2, 4, 4, 3));
  EXPECT_GT(flat.zero, 500u);

  EXPECT_EQ(flat.exact, 0u) << "numbers so small that the first tier knows them from 0";
  EXPECT_EQ(flat.wide, 0u) << "coplanar facets need no depth plane";
  EXPECT_EQ(flat.same_planes, 0u);
}

TYPED_TEST(TiersOf, IntegersTellWhatIsAUnitFromZero) {
  // Two planes through the ray a, a unit apart at its end, intersect in a. A third plane misses a by a
  // unit. Their determinant is about 2^120, and the products in it 2^180, which exceeds the precision of a
  // double.
  Random random(7);
  Tiers tiers;
  Counting<TypeParam> arithmetic;
  arithmetic.tiers = &tiers;
  constexpr int cases = 2000;
  std::size_t not_zero = 0;
  for (int k = 0; k < cases; ++k) {
    SCOPED_TRACE(testing::Message() << "seed 7, case " << k);
    const auto any = [&] {
      const auto large = [&] { return uniform(random, -(1 << 29), 1 << 29); };
      return GridPoint{large(), large(), large()};
    };
    const auto moved = [&](GridPoint p) { return GridPoint{p.x + 1, p.y - uniform(random, 0, 1), p.z}; };
    const GridPoint a = any(), b = any(), d = any(), beside_a = moved(a), beside_b = moved(b);
    const auto plane = [&](auto& kernel, auto& planes) {
      kernel.through(planes[0], a, b);
      kernel.through(planes[1], a, beside_b);
      kernel.through(planes[2], beside_a, d);
    };
    std::array<typename TypeParam::Plane, 3> planes;
    typename TypeParam::Corner corner;
    std::array<RationalArithmetic::Plane, 3> exact_planes;
    RationalArithmetic::Corner exact_corner;
    int sign = 0;
    {
      [[maybe_unused]] const FilteredArithmetic::Guard guard;  // harmless to the other
      plane(arithmetic, planes);
      arithmetic.meet(corner, planes[0], planes[1], 1);
      sign = arithmetic.side(corner, planes[2]);
    }
    RationalArithmetic rational;
    plane(rational, exact_planes);
    rational.meet(exact_corner, exact_planes[0], exact_planes[1], 1);
    ASSERT_EQ(sign, rational.side(exact_corner, exact_planes[2]));
    not_zero += sign != 0;
  }
  EXPECT_GT(not_zero, cases * 9 / 10);
  EXPECT_GT(tiers.exact, cases * 9 / 10);
  EXPECT_EQ(tiers.exact + tiers.first, not_zero);
}

/// Counts the decisions for all views of one kind of small scene.
template <class A>
Tiers tiers_of_kind(std::string_view kind) {
  Tiers sum;
  for (std::uint64_t scene = 0; scene < 200 * prove::generator_names.size(); ++scene) {
    if (prove::generator_names[scene % prove::generator_names.size()] != kind) continue;
    const prove::SmallScene small = prove::make_scene(1, scene);
    sum.add(tiers_of<A>(small.mesh, small.tubes));
  }
  EXPECT_GT(sum.first, 100000u);
  EXPECT_EQ(sum.same_planes, 0u);
  return sum;
}

TEST(Tiers, NeedleWallsNeedIntegersOnlyWhereTheirNormalsAreIntervals) {
  // The normal of a wall is a difference of products of 2^60 that agree in all except the last bits.
  // `fixed` computes the difference in integers first and rounds afterwards.
  EXPECT_EQ(tiers_of_kind<FixedArithmetic>("needle tubes").exact, 0u);
  EXPECT_GT(tiers_of_kind<FilteredArithmetic>("needle tubes").exact, 1000u);
}

TEST(Tiers, SliversNeedIntegersWhereOneErrorBoundServesAllCoordinates) {
  // The planes of a sliver differ in a small coordinate of large normals. An interval per coordinate
  // resolves this difference.
  const Tiers fixed = tiers_of_kind<FixedArithmetic>("slivers");
  EXPECT_GT(fixed.exact, 10u);
  EXPECT_LT(fixed.exact * 500, fixed.first);
  EXPECT_LT(tiers_of_kind<FilteredArithmetic>("slivers").exact * 10, fixed.exact);
}

TYPED_TEST(TiersOf, DepthPlanesNeedWideIntegersOnlyForTheirZeros) {
  // Facets that intersect each other along lines through common points.
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Tiers tiny = tiers_of<TypeParam>(make_random_triangles(random, 20, 6, 3),
                                           lattice_tubes({0, 0, 0}, -2, -2, 4, 4, 6));
    EXPECT_GT(tiny.wide, 0u);
    EXPECT_EQ(tiny.exact, 0u);
    EXPECT_EQ(tiny.same_planes, 0u);
  }
}

}  // namespace
}  // namespace tubefoot
