// SPDX-License-Identifier: GPL-3.0-or-later
// Tests coverage. The comparisons are closed forms, areas of intersections in rationals, and the same
// coverage with other orders and tubes. The rationals use inclusion and exclusion, independent of the
// splitting of cells.
#include "geometry/footprints/coverage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "fixtures/geometry/coverage_oracle.hpp"
#include "fixtures/geometry/grid_scenes.hpp"
#include "fixtures/geometry/looks.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::add_square;
using test::cover;
using test::down_tubes;
using test::look;
using test::oracle;
using test::Q;
using test::Shares;
using test::shares_of;

TEST(Coverage, ShadowOfAPlateIsThePlateScaled) {
  FacetMesh mesh;
  add_square(mesh, 1000, 0);
  add_square(mesh, 100, 300);
  const auto facets =
      cover(mesh, {look(mesh, down_tubes({0, 0, 1000}, {-2000, 2000}, {-2000, 2000}, 1000), 0)});
  ASSERT_EQ(facets.size(), 4u);
  // The shadow is the plate times 10/7: (1000/7)^2 of 1000^2.
  for (const FacetId seabed : {0u, 1u}) {
    EXPECT_EQ(facets.at(seabed).shadow.exact, "1/49");
    EXPECT_EQ(facets.at(seabed).seen.exact, "48/49");
    ASSERT_EQ(facets.at(seabed).by_pings.size(), 2u);
    EXPECT_EQ(facets.at(seabed).by_pings[0].pings, 0u);
    EXPECT_EQ(facets.at(seabed).by_pings[0].exact, "1/49");
  }
  for (const FacetId plate : {2u, 3u}) {
    EXPECT_EQ(facets.at(plate).seen.exact, "1");
    EXPECT_EQ(facets.at(plate).shadow.exact, "0");
  }
}

TEST(Coverage, WhatIsOutOfTheSectorIsNeverSeenAndInNoShadow) {
  FacetMesh mesh;
  add_square(mesh, 1000, 0);
  // A strip |x| < 100 of the seabed.
  const auto facets =
      cover(mesh, {look(mesh, down_tubes({0, 0, 1000}, {-100, 100}, {-3000, 3000}, 1000), 0)});
  Q seen = 0;
  for (const auto& [id, facet] : facets) {
    seen += Q(facet.seen.exact);
    EXPECT_EQ(facet.shadow.exact, "0");
  }
  EXPECT_EQ(seen, Q(2) / 10);
}

TEST(Coverage, TwoPingsOverlap) {
  FacetMesh mesh;
  add_square(mesh, 1000, 0);
  // Strips -300 < x < 100 and -100 < x < 300.
  const auto facets =
      cover(mesh, {look(mesh, down_tubes({-100, 0, 1000}, {-200, 200}, {-3000, 3000}, 1000), 0),
                   look(mesh, down_tubes({100, 0, 1000}, {-200, 200}, {-3000, 3000}, 1000), 1)});
  std::map<std::uint32_t, Q> sum;
  for (const auto& [id, facet] : facets)
    for (const AreaShare& part : facet.by_pings) sum[part.pings] += Q(part.exact);
  EXPECT_EQ(sum[0], Q(14) / 10);
  EXPECT_EQ(sum[1], Q(4) / 10);
  EXPECT_EQ(sum[2], Q(2) / 10);
}

TEST(Coverage, LooksOfOnePingCountOnce) {
  FacetMesh mesh;
  add_square(mesh, 1000, 0);
  const TubeSet tubes = down_tubes({0, 0, 1000}, {-200, 0, 200}, {-3000, 3000}, 1000);
  const auto once = cover(mesh, {look(mesh, tubes, 0), look(mesh, tubes, 0)});
  const auto twice = cover(mesh, {look(mesh, tubes, 0), look(mesh, tubes, 1)});
  for (const FacetId id : {0u, 1u}) {
    EXPECT_EQ(once.at(id).seen.pings, 1u);
    EXPECT_EQ(twice.at(id).seen.pings, 2u);
    EXPECT_EQ(once.at(id).seen.exact, twice.at(id).seen.exact);
  }
}

TEST(Coverage, AFacetInLineWithTheApexIsNeitherSeenNorInAShadow) {
  FacetMesh mesh;
  add_square(mesh, 1000, 0);
  const TubeSet above = down_tubes({0, 0, 1000}, {-3000, 3000}, {-3000, 3000}, 1000);
  TubeSet level = test::lattice_tubes({0, -5000, 0}, -1, -1, 2, 2, 1);
  EXPECT_TRUE(cover(mesh, {look(mesh, level, 0)}).empty());
  const auto both = cover(mesh, {look(mesh, level, 0), look(mesh, above, 1)});
  ASSERT_EQ(both.size(), 2u);
  for (const auto& [id, facet] : both) {
    EXPECT_EQ(facet.by_pings.size(), 1u);
    EXPECT_EQ(facet.by_pings[0].pings, 1u);
    EXPECT_EQ(facet.seen.exact, "1");
  }
}

TEST(Coverage, BothSidesOfAFacetCount) {
  FacetMesh mesh;
  add_square(mesh, 1000, 0);
  TubeSet below = test::lattice_tubes({0, 0, -1000}, -3, -3, 1, 1, 1);
  below.rays = {{-200, -3000, 1000}, {200, -3000, 1000}, {200, 3000, 1000}, {-200, 3000, 1000}};
  below.tubes = {{0, 1, 2, 3}};
  const auto facets = cover(
      mesh,
      {look(mesh, below, 0), look(mesh, down_tubes({0, 0, 1000}, {-100, 300}, {-3000, 3000}, 1000), 1)});
  std::map<std::uint32_t, Q> sum;
  for (const auto& [id, facet] : facets)
    for (const AreaShare& part : facet.by_pings) sum[part.pings] += Q(part.exact);
  EXPECT_EQ(sum[2], Q(3) / 10);
  EXPECT_EQ(sum[1], Q(2) / 10);
}

TEST(Coverage, TheWindowOfRangesCutsByPolygonsOf96Sides) {
  FacetMesh mesh;
  constexpr std::int32_t m = 1 << 16;
  add_square(mesh, 4000 * m, 0);
  CoverageLook from = look(mesh, down_tubes({0, 0, 1000 * m}, {-3000, 3000}, {-3000, 3000}, 1000), 0);
  from.farthest = 2000.0 * m;
  from.nearest = 1100.0 * m;
  // Corners are rounded to the grid: half a unit along 14 km of outline.
  const double outer2 = 3e6, inner2 = 0.21e6, n = 96;
  const double outer = n / 2 * outer2 * std::sin(2 * pi / n), inner = n * inner2 * std::tan(pi / n);
  double seen = 0, shadow = 0, cells = 0;
  for (const auto& [id, facet] : cover(mesh, {from})) {
    seen += facet.seen.share / 2;
    shadow += facet.shadow.share;
    for (const CoverageCell& cell : facet.cells) {
      if (cell.pings == 0) continue;
      for (std::uint32_t k = 0; k < cell.count; ++k) {
        const glm::dvec3 corner = facet.corners[cell.first + k];
        const double range = glm::distance(corner, glm::dvec3(0, 0, 1000.0 * m));
        EXPECT_LE(range, from.farthest * (1 + 1e-8));
        EXPECT_GE(range, from.nearest * (1 - 1e-8));
      }
      for (std::uint32_t k = 1; k + 1 < cell.count; ++k)
        cells += glm::length(glm::cross(facet.corners[cell.first + k] - facet.corners[cell.first],
                                        facet.corners[cell.first + k + 1] - facet.corners[cell.first])) /
                 2;
    }
  }
  EXPECT_NEAR(seen * 64e6, outer - inner, 0.1);
  EXPECT_NEAR(cells / m / m, outer - inner, 0.1);
  EXPECT_EQ(shadow, 0) << "beyond the window is no shadow";
}

// Law O1.
TEST(Coverage, IsThatOfInclusionAndExclusionInRationals) {
  std::size_t cut = 0, shadows = 0, several = 0;
  for (std::uint64_t seed = 1; seed <= 24 / test::one_in; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Random random(seed);
    FacetMesh mesh = seed % 3 == 0   ? test::rough_terrain(random, 4, 4000, -1500, 500)
                     : seed % 3 == 1 ? test::make_random_triangles(random, 10, 3000, 1500)
                                     : test::make_random_triangles(random, 6, 3000, 2500);
    if (seed % 4 == 0) test::duplicate_facets(random, mesh, seed % 8 == 0);
    std::vector<CoverageLook> looks;
    for (std::uint32_t ping = 0; ping < 3; ++ping) {
      const GridPoint apex{test::uniform(random, -600, 600), test::uniform(random, -300, 300),
                           test::uniform(random, -600, 600)};
      looks.push_back(look(mesh, test::forward_tubes(apex, 2, 2, 70, 60, seed % 3 == 0 ? 25 : 0), ping));
    }
    const Shares found = shares_of(cover(mesh, looks)), expected = oracle(mesh, looks);
    ASSERT_EQ(found.size(), expected.size());
    for (const auto& [facet, shares] : expected) {
      ASSERT_TRUE(found.count(facet)) << "facet " << facet;
      EXPECT_EQ(found.at(facet).first, shares.first) << "facet " << facet;
      EXPECT_EQ(found.at(facet).second, shares.second) << "facet " << facet;
      cut += shares.first.size() > 1;
      shadows += shares.second > 0;
      several += shares.first.count(3);
    }
  }
  EXPECT_GT(cut, 100 / test::one_in);
  EXPECT_GT(shadows, 50 / test::one_in);
  EXPECT_GT(several, 30 / test::one_in);
}

// Law O2.
TEST(Coverage, NeitherOrderOfPingsNorSplittingOfTubesChangesAnything) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Random random(seed);
    FacetMesh mesh = test::make_random_triangles(random, 12, 0, 1500);
    add_square(mesh, 3000, -2000);
    std::vector<CoverageLook> whole, split, backwards;
    for (std::uint32_t ping = 0; ping < 4; ++ping) {
      const GridPoint apex{test::uniform(random, -600, 600), test::uniform(random, -600, 600), 3000};
      whole.push_back(look(mesh, down_tubes(apex, {-700, 800}, {-600, 500}, 1000), ping));
      split.push_back(look(mesh, down_tubes(apex, {-700, -300, -299, 5, 800}, {-600, 10, 500}, 1000), ping));
    }
    for (std::uint32_t ping = 0; ping < 4; ++ping) {
      backwards.push_back(split[3 - ping]);
      backwards.back().ping = ping;
    }
    const Shares expected = shares_of(cover(mesh, whole));
    EXPECT_GT(expected.size(), 8u);
    EXPECT_EQ(shares_of(cover(mesh, split)), expected);
    EXPECT_EQ(shares_of(cover(mesh, backwards)), expected);
  }
}

TEST(Coverage, ManyPingsOfALargeFacetClose) {
  FacetMesh mesh;
  add_square(mesh, 100000, 0);
  std::vector<std::int32_t> across;  // enough pieces that the facet is bisected
  for (std::int32_t x = -3000; x <= 3000; x += 500) across.push_back(x);
  std::vector<CoverageLook> looks;
  for (std::uint32_t ping = 0; ping < 120; ++ping)
    looks.push_back(look(
        mesh,
        down_tubes({0, static_cast<std::int32_t>(1000 * ping) - 60000, 20000}, across, {-100, 100}, 1000),
        ping));
  // Strips of width 4000 at intervals of 1000, 120000 wide: four overlap except at the ends.
  std::map<std::uint32_t, Q> sum;
  for (const auto& [id, facet] : cover(mesh, looks))
    for (const AreaShare& part : facet.by_pings) sum[part.pings] += Q(part.exact) * 20000000000;
  EXPECT_EQ(sum[1], Q(2) * 1000 * 120000);
  EXPECT_EQ(sum[2], Q(2) * 1000 * 120000);
  EXPECT_EQ(sum[3], Q(2) * 1000 * 120000);
  EXPECT_EQ(sum[4], Q(117) * 1000 * 120000);
}

// Law O6. Shares without an exact fraction have a bound of their error.
TEST(Coverage, MeanNumberOfPingsIsTheSumOfTheSharesOfEachPing) {
  std::size_t exact = 0, rounded = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Random random(seed);
    FacetMesh mesh = test::make_random_triangles(random, 8, 0, 1500);
    add_square(mesh, 3000, -2000);
    std::vector<CoverageLook> looks;
    std::map<FacetId, Q> expected;
    for (std::uint32_t ping = 0; ping < 24; ++ping) {
      const GridPoint apex{test::uniform(random, -900, 900), test::uniform(random, -900, 900), 3000};
      const TubeSet tubes = down_tubes(apex, {-700, -640, -471, -300, -299, -120, 5, 77, 310, 500, 671, 800},
                                       {-603, 511}, 1000);
      looks.push_back(look(mesh, tubes, ping));
      for (const auto& [id, facet] : cover(mesh, {looks.back()})) expected[id] += Q(facet.seen.exact);
    }
    for (const auto& [id, facet] : cover(mesh, looks)) {
      double mean = 0, error = 0, sum = 0;
      Q exact_mean = 0;
      bool all_exact = true;
      for (const AreaShare& part : facet.by_pings) {
        mean += part.pings * part.share;
        error += part.pings * part.error;
        sum += part.share;
        all_exact = all_exact && !part.exact.empty();
        if (all_exact) exact_mean += Q(part.pings) * Q(part.exact);
      }
      EXPECT_NEAR(mean, expected[id].convert_to<double>(), error + 1e-14);
      EXPECT_LT(error, 1e-9);
      EXPECT_NEAR(sum, 1, 1e-11);
      if (all_exact) {
        EXPECT_EQ(exact_mean, expected[id]);
      }
      (all_exact ? exact : rounded) += 1;
    }
  }
  EXPECT_GT(exact + rounded, 10u);
}

// The cells of a ping depend on the border of its beams, not on their number.
TEST(Coverage, NumberOfBeamsDoesNotChangeTheNumberOfCells) {
  FacetMesh mesh;
  add_square(mesh, 3000, 0);
  std::vector<std::int32_t> many;
  for (std::int32_t x = -500; x <= 500; x += 10) many.push_back(x);
  const auto cells = [&](const std::vector<std::int32_t>& across) {
    std::vector<CoverageLook> looks;
    for (std::uint32_t ping = 0; ping < 6; ++ping)
      looks.push_back(
          look(mesh, down_tubes({0, static_cast<std::int32_t>(100 * ping), 1000}, across, {-333, 333}, 1000),
               ping));
    std::size_t count = 0;
    for (const auto& [id, facet] : cover(mesh, looks)) count += facet.cells.size();
    return count;
  };
  EXPECT_EQ(cells(many), cells({-500, 500}));
  EXPECT_LT(cells(many), 120u);
}

TEST(Coverage, WhatIsInTheWayIsTheNearest) {
  FacetMesh mesh;
  add_square(mesh, 1000, 0);
  add_square(mesh, 100, 300);
  add_square(mesh, 50, 500);
  const SceneTree tree(mesh);
  EXPECT_EQ(first_in_the_way(mesh, tree, {0, 0, 1000}, {10, 20, 0}), 5u);
  EXPECT_EQ(first_in_the_way(mesh, tree, {0, 0, 1000}, {130, 20, 0}), 2u);
  EXPECT_EQ(first_in_the_way(mesh, tree, {0, 0, 1000}, {300, 20, 0}), no_facet);
}

}  // namespace
}  // namespace tubefoot
