// SPDX-License-Identifier: GPL-3.0-or-later
// Coverage against closed forms, against areas of intersections in rationals (inclusion and exclusion, which
// shares nothing with the splitting of cells), and against itself in another order and other tubes.
#include "geometry/footprints/coverage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>

#include "fixtures/geometry/exact_oracles.hpp"
#include "fixtures/geometry/grid_scenes.hpp"
#include "fixtures/geometry/looks.hpp"

namespace tubefoot {
namespace {

using test::Q;
using test::V3;

CoverageLook look(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t ping) {
  const SceneTree tree(mesh);
  VisibilityScratch scratch;
  CoverageLook result{ping, tubes, std::vector<TubeVisibility>(tubes.tubes.size())};
  for (std::uint32_t t = 0; t < tubes.tubes.size(); ++t)
    see(mesh, tree, tubes, t, VisibilityOptions{}, scratch, result.seen[t]);
  return result;
}

std::map<FacetId, FacetCoverage> cover(const FacetMesh& mesh, const std::vector<CoverageLook>& looks) {
  const SceneTree tree(mesh);
  const Coverage coverage(mesh, tree, looks);
  std::map<FacetId, FacetCoverage> facets;
  for (std::size_t k = 0; k < coverage.facets(); ++k) {
    FacetCoverage facet = coverage.facet(k);
    EXPECT_TRUE(facet.closes) << "facet " << facet.facet;
    if (facet.met()) facets[facet.facet] = std::move(facet);
  }
  return facets;
}

/// Exact shares by number of pings, and in the shadow.
using Shares = std::map<FacetId, std::pair<std::map<std::uint32_t, Q>, Q>>;

Shares shares_of(const std::map<FacetId, FacetCoverage>& facets) {
  Shares shares;
  for (const auto& [id, facet] : facets) {
    auto& [by_pings, shadow] = shares[id];
    Q sum = 0, seen = 0;
    for (const AreaShare& part : facet.by_pings) {
      by_pings[part.pings] = Q(part.exact);
      sum += Q(part.exact);
      if (part.pings > 0) seen += Q(part.exact);
      EXPECT_NEAR(part.share, Q(part.exact).convert_to<double>(), 1e-15);
    }
    EXPECT_EQ(sum, 1);
    EXPECT_EQ(seen, Q(facet.seen.exact));
    shadow = Q(facet.shadow.exact);
  }
  return shares;
}

/// Tubes that look down through the lattice points (x, y) of the plane one `depth` below.
TubeSet down_tubes(GridPoint apex, std::vector<std::int32_t> x, std::vector<std::int32_t> y,
                   std::int32_t depth) {
  TubeSet set;
  set.apex = apex;
  set.reach = 1e12;
  for (const std::int32_t v : y)
    for (const std::int32_t u : x) set.rays.push_back({u, v, -depth});
  const auto columns = static_cast<std::uint32_t>(x.size());
  for (std::uint32_t j = 0; j + 1 < y.size(); ++j)
    for (std::uint32_t i = 0; i + 1 < columns; ++i) {
      const std::uint32_t a = j * columns + i;
      set.tubes.push_back({a, a + columns, a + columns + 1, a + 1});
    }
  return set;
}

/// A square in the plane z, as two facets.
void add_square(FacetMesh& mesh, std::int32_t half, std::int32_t z) {
  const VertexId a = test::add_vertex(mesh, {-half, -half, z}), b = test::add_vertex(mesh, {half, -half, z}),
                 c = test::add_vertex(mesh, {half, half, z}), d = test::add_vertex(mesh, {-half, half, z});
  test::add_facet(mesh, a, b, c);
  test::add_facet(mesh, a, c, d);
}

TEST(Coverage, ShadowOfAPlateIsThePlateScaled) {
  FacetMesh mesh;
  add_square(mesh, 1000, 0);
  add_square(mesh, 100, 300);
  const auto facets =
      cover(mesh, {look(mesh, down_tubes({0, 0, 1000}, {-2000, 2000}, {-2000, 2000}, 1000), 0)});
  ASSERT_EQ(facets.size(), 4u);
  // The shadow is the plate times 10/7: (1000/7)^2 of 1000^2.
  for (const FacetId bed : {0u, 1u}) {
    EXPECT_EQ(facets.at(bed).shadow.exact, "1/49");
    EXPECT_EQ(facets.at(bed).seen.exact, "48/49");
    ASSERT_EQ(facets.at(bed).by_pings.size(), 2u);
    EXPECT_EQ(facets.at(bed).by_pings[0].pings, 0u);
    EXPECT_EQ(facets.at(bed).by_pings[0].exact, "1/49");
  }
  for (const FacetId plate : {2u, 3u}) {
    EXPECT_EQ(facets.at(plate).seen.exact, "1");
    EXPECT_EQ(facets.at(plate).shadow.exact, "0");
  }
}

TEST(Coverage, WhatIsOutOfTheSectorIsNeverSeenAndInNoShadow) {
  FacetMesh mesh;
  add_square(mesh, 1000, 0);
  // A strip |x| < 100 of the bed.
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
  const double outer2 = 3e6, inner2 = 0.21e6, n = 96, pi = std::numbers::pi;
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

// ---- inclusion and exclusion in rationals

using P2 = std::array<Q, 2>;
using Poly = std::vector<P2>;

Q doubled_area(const Poly& p) {
  Q sum = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const P2 &a = p[k], &b = p[(k + 1) % p.size()];
    sum += a[0] * b[1] - a[1] * b[0];
  }
  return sum;
}

Poly counter_clockwise(Poly p) {
  if (doubled_area(p) < 0) std::reverse(p.begin(), p.end());
  return p;
}

Poly meet(Poly p, const Poly& by) {
  for (std::size_t k = 0; k < by.size() && !p.empty(); ++k) {
    const P2 &a = by[k], &b = by[(k + 1) % by.size()];
    const auto height = [&](const P2& x) {
      return Q((b[0] - a[0]) * (x[1] - a[1]) - (b[1] - a[1]) * (x[0] - a[0]));
    };
    Poly rest;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const P2 &x = p[i], &y = p[(i + 1) % p.size()];
      const Q hx = height(x), hy = height(y);
      if (hx >= 0) rest.push_back(x);
      if ((hx > 0 && hy < 0) || (hx < 0 && hy > 0)) {
        const Q t = hx / (hx - hy);
        rest.push_back({Q(x[0] + t * (y[0] - x[0])), Q(x[1] + t * (y[1] - x[1]))});
      }
    }
    p = doubled_area(rest) > 0 ? rest : Poly{};
  }
  return p;
}

/// Area in exactly k of the sets, each a union of polygons without common area.
std::vector<Q> areas_by_count(const std::vector<std::vector<Poly>>& sets) {
  const std::size_t n = sets.size();
  std::vector<Q> sums(n + 1, Q(0)), exactly(n + 1, Q(0));
  for (unsigned which = 1; which < 1u << n; ++which) {
    std::vector<Poly> common;
    bool first = true;
    for (std::size_t s = 0; s < n; ++s) {
      if (!(which >> s & 1)) continue;
      if (first) {
        common = sets[s];
        first = false;
        continue;
      }
      std::vector<Poly> next;
      for (const Poly& p : common)
        for (const Poly& q : sets[s])
          if (Poly r = meet(p, q); !r.empty()) next.push_back(std::move(r));
      common = std::move(next);
    }
    for (const Poly& p : common) sums[static_cast<std::size_t>(__builtin_popcount(which))] += doubled_area(p);
  }
  for (std::size_t k = 1; k <= n; ++k) {
    Q binomial = 1;  // j choose k
    for (std::size_t j = k; j <= n; ++j) {
      if ((j - k) % 2 == 0)
        exactly[k] += binomial * sums[j];
      else
        exactly[k] -= binomial * sums[j];
      binomial = binomial * Q(static_cast<long>(j + 1)) / Q(static_cast<long>(j + 1 - k));
    }
  }
  return exactly;
}

Shares oracle(const FacetMesh& mesh, const std::vector<CoverageLook>& looks) {
  Shares shares;
  for (FacetId f = 0; f < mesh.facets.size(); ++f) {
    std::array<V3, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) corner[k] = test::vec(mesh.vertices[mesh.facets[f][k]]);
    const V3 n = test::vector_product(test::minus(corner[1], corner[0]), test::minus(corner[2], corner[0]));
    const std::size_t out = n[2] != 0 ? 2 : n[1] != 0 ? 1 : 0;
    if (n[out] == 0) continue;
    const auto plan = [&](const V3& p) { return P2{p[out == 0 ? 1 : 0], p[out == 2 ? 1 : 2]}; };
    const Poly whole = counter_clockwise({plan(corner[0]), plan(corner[1]), plan(corner[2])});
    std::vector<std::vector<Poly>> seen, within;
    for (const CoverageLook& from : looks) {
      seen.emplace_back();
      within.emplace_back();
      const auto facet = test::seen_from(mesh, f, from.tubes.apex);
      if (!facet) continue;
      const V3 apex = test::vec(from.tubes.apex);
      const auto place = [&](const V3& d) {
        V3 p = test::times(Q(facet->c / test::scalar_product(facet->n, d)), d);
        for (int k = 0; k < 3; ++k) p[k] += apex[k];
        return plan(p);
      };
      for (std::uint32_t t = 0; t < from.tubes.tubes.size(); ++t) {
        for (const NamedPiece& piece : from.seen[t].pieces) {
          if (piece.facet != f) continue;
          Poly p;
          for (const V3& d : test::cone_of(mesh, from.tubes.apex, from.seen[t], piece)) p.push_back(place(d));
          if (doubled_area(p) != 0) seen.back().push_back(counter_clockwise(p));
        }
        // The facet within the tube's walls, in space.
        std::vector<V3> part(facet->vertex.begin(), facet->vertex.end());
        for (std::size_t k = 0; k < 4; ++k) {
          const V3 wall = test::vector_product(test::vec(from.tubes.rays[from.tubes.tubes[t][k]]),
                                               test::vec(from.tubes.rays[from.tubes.tubes[t][(k + 1) % 4]]));
          std::vector<V3> rest;
          for (std::size_t i = 0; i < part.size(); ++i) {
            const V3 &x = part[i], &y = part[(i + 1) % part.size()];
            const Q hx = test::scalar_product(wall, x), hy = test::scalar_product(wall, y);
            if (hx >= 0) rest.push_back(x);
            if ((hx > 0 && hy < 0) || (hx < 0 && hy > 0)) {
              V3 p = test::times(Q(hx / (hx - hy)), test::minus(y, x));
              for (int c = 0; c < 3; ++c) p[c] += x[c];
              rest.push_back(p);
            }
          }
          part = std::move(rest);
        }
        Poly p;
        for (V3 x : part) {
          for (int c = 0; c < 3; ++c) x[c] += apex[c];
          p.push_back(plan(x));
        }
        if (doubled_area(p) != 0) within.back().push_back(counter_clockwise(p));
      }
    }
    const Q total = doubled_area(whole);
    const std::vector<Q> by_pings = areas_by_count(seen), by_sectors = areas_by_count(within);
    Q covered = 0, in_sectors = 0;
    auto& [its, shadow] = shares[f];
    for (std::size_t k = 1; k < by_pings.size(); ++k) {
      if (by_pings[k] != 0) its[static_cast<std::uint32_t>(k)] = by_pings[k] / total;
      covered += by_pings[k];
      in_sectors += by_sectors[k];
    }
    if (covered != total) its[0] = Q(total - covered) / total;
    shadow = Q(in_sectors - covered) / total;
    if (in_sectors == 0) shares.erase(f);
  }
  return shares;
}

// Law O1.
TEST(Coverage, IsThatOfInclusionAndExclusionInRationals) {
  std::size_t cut = 0, shadows = 0, several = 0;
  for (std::uint64_t seed = 1; seed <= 24 / test::one_in; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Random random(seed);
    FacetMesh mesh = seed % 3 == 0   ? test::rough_terrain(random, 4, 4000, -1500, 500)
                     : seed % 3 == 1 ? test::random_soup(random, 10, 3000, 1500)
                                     : test::random_soup(random, 6, 3000, 2500);
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
    FacetMesh mesh = test::random_soup(random, 12, 0, 1500);
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
  std::vector<std::int32_t> across;  // enough pieces for the facet to be halved
  for (std::int32_t x = -3000; x <= 3000; x += 500) across.push_back(x);
  std::vector<CoverageLook> looks;
  for (std::uint32_t ping = 0; ping < 120; ++ping)
    looks.push_back(look(
        mesh,
        down_tubes({0, static_cast<std::int32_t>(1000 * ping) - 60000, 20000}, across, {-100, 100}, 1000),
        ping));
  // Strips of 4000 every 1000, 120000 wide: four on top of each other but at the ends.
  std::map<std::uint32_t, Q> sum;
  for (const auto& [id, facet] : cover(mesh, looks))
    for (const AreaShare& part : facet.by_pings) sum[part.pings] += Q(part.exact) * 20000000000;
  EXPECT_EQ(sum[1], Q(2) * 1000 * 120000);
  EXPECT_EQ(sum[2], Q(2) * 1000 * 120000);
  EXPECT_EQ(sum[3], Q(2) * 1000 * 120000);
  EXPECT_EQ(sum[4], Q(117) * 1000 * 120000);
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
