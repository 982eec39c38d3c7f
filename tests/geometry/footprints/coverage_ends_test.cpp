// SPDX-License-Identifier: GPL-3.0-or-later
// Tests coverage by looks with two ends, and by looks at separate seabed meshes. The comparisons are
// inclusion and exclusion in rationals, closed forms, and equivalent inputs.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>

#include "fixtures/geometry/coverage_oracle.hpp"
#include "geometry/mesh/edge_refinement.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using namespace test;

FacetMesh scene_of(std::uint64_t seed, Random& random) {
  FacetMesh mesh = seed % 3 == 0   ? rough_terrain(random, 4, 4000, -1500, 500)
                   : seed % 3 == 1 ? make_random_triangles(random, 10, 3000, 1500)
                                   : make_random_triangles(random, 6, 3000, 2500);
  if (seed % 4 == 0) duplicate_facets(random, mesh, seed % 8 == 0);
  return mesh;
}

GridPoint place_in(Random& random) {
  return {uniform(random, -600, 600), uniform(random, -300, 300), uniform(random, -600, 600)};
}

/// Returns three pings. Every second ping has a separate receiver, or each ping if `all`.
std::vector<CoverageLook> looks_at(const FacetMesh& mesh, std::uint64_t seed, Random& random, bool all) {
  const double tilt = seed % 3 == 0 ? 25 : 0;
  std::vector<CoverageLook> looks;
  for (std::uint32_t ping = 0; ping < 3; ++ping) {
    const TubeSet tx = forward_tubes(place_in(random), 2, 2, 70, 60, tilt),
                  rx = forward_tubes(place_in(random), 3, 1, 60, 50, tilt);
    looks.push_back(all || ping % 2 == 0 ? look(mesh, tx, rx, ping) : look(mesh, tx, ping));
  }
  return looks;
}

// Law O1.
TEST(CoverageOfTwoEnds, IsThatOfInclusionAndExclusionInRationals) {
  std::size_t cut = 0, shadows = 0, several = 0;
  for (std::uint64_t seed = 1; seed <= 12 / one_in; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const FacetMesh mesh = scene_of(seed, random);
    const std::vector<CoverageLook> looks = looks_at(mesh, seed, random, false);
    const Shares found = shares_of(cover(mesh, looks)), expected = oracle(mesh, looks);
    EXPECT_EQ(found.size(), expected.size());
    for (const auto& [facet, shares] : expected) {
      ASSERT_TRUE(found.count(facet)) << "facet " << facet;
      EXPECT_EQ(found.at(facet).first, shares.first) << "facet " << facet;
      EXPECT_EQ(found.at(facet).second, shares.second) << "facet " << facet;
      cut += shares.first.size() > 1;
      shadows += shares.second > 0;
      several += shares.first.count(2);
    }
  }
  EXPECT_GT(cut, 30 / one_in);
  EXPECT_GT(shadows, 20 / one_in);
  EXPECT_GT(several, 10 / one_in);
}

// Law O4.
TEST(CoverageOfTwoEnds, ExchangedIsTheSameAndInOnePlaceIsThatOfOne) {
  for (std::uint64_t seed = 1; seed <= 12 / one_in; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const FacetMesh mesh = scene_of(seed, random);
    std::vector<CoverageLook> looks = looks_at(mesh, seed, random, true), once, twice;
    const Shares expected = shares_of(cover(mesh, looks));
    for (const CoverageLook& its : looks) {
      once.push_back({its.ping, its.tx});
      twice.push_back({its.ping, its.tx});
      twice.back().rx = its.tx;
    }
    for (CoverageLook& its : looks) std::swap(its.tx, *its.rx);
    EXPECT_EQ(shares_of(cover(mesh, looks)), expected);
    EXPECT_EQ(shares_of(cover(mesh, twice)), shares_of(cover(mesh, once)));
  }
}

TEST(CoverageOfTwoEnds, SeeingDifferentSidesIsSeenByNone) {
  FacetMesh mesh;
  add_square(mesh, 1000, 0);
  TubeSet below = lattice_tubes({0, 0, -1000}, -3, -3, 1, 1, 1);
  below.rays = {{-200, -3000, 1000}, {200, -3000, 1000}, {200, 3000, 1000}, {-200, 3000, 1000}};
  below.tubes = {{0, 1, 2, 3}};
  const TubeSet above = down_tubes({0, 0, 1000}, {-100, 300}, {-3000, 3000}, 1000);
  for (const auto& [id, facet] : cover(mesh, {look(mesh, above, below, 0)})) {
    EXPECT_EQ(facet.seen.exact, "0");
    EXPECT_GT(facet.shadow.share, 0.1);  // both contain it in their tubes
  }
}

/// A plate hides from the receiver a part that it does not hide from the transmitter. The result names the
/// occluding facet.
TEST(CoverageOfTwoEnds, TheShadowIsThatOfBothAndTheOccluderOfTheFirstThatIsHidden) {
  FacetMesh mesh;
  add_square(mesh, 1000, 0);
  add_square(mesh, 100, 500);
  const auto down = [](std::int32_t x) {
    return down_tubes({x, 0, 1000}, {-4000, 4000}, {-2000, 2000}, 1000);
  };
  const std::vector<CoverageLook> looks{look(mesh, down(-450), down(450), 0)};
  const SceneTree tree(mesh);
  const Coverage coverage(mesh, tree, looks);
  Q shadow = 0;
  std::set<FacetId> occluders;
  for (std::size_t k = 0; k < coverage.facets(); ++k) {
    const FacetCoverage facet = coverage.facet(k);
    if (facet.facet > 1) continue;
    shadow += Q(facet.shadow.exact) * 2000000;
    for (const CoverageCell& cell : facet.cells)
      if (cell.in_sector > 0) occluders.insert(coverage.occluder(facet, cell));
    // The plate is the facets 2 and 3.
    for (const FacetId occluder : occluders) EXPECT_TRUE(occluder == 2 || occluder == 3) << occluder;
  }
  // Squares of 400 on either side of the plate, separate from each other.
  EXPECT_EQ(shadow, 2 * 400 * 400);
  EXPECT_FALSE(occluders.empty());
}

/// Half paths of one length meet a plane in an ellipse: the section of a spheroid about both ends.
TEST(CoverageOfTwoEnds, TheWindowCutsByPolygonsOf96SidesOfEllipses) {
  constexpr std::int32_t m = 1 << 16;
  for (const auto& [t, r] :
       {std::pair{GridPoint{-900 * m, 0, 1000 * m}, GridPoint{900 * m, 0, 1000 * m}},
        std::pair{GridPoint{-300 * m, 200 * m, 1000 * m}, GridPoint{700 * m, -400 * m, 600 * m}}}) {
    FacetMesh mesh;
    add_square(mesh, 8000 * m, 0);
    const auto sector = [](GridPoint apex) {
      return down_tubes(apex, {-30000, 30000}, {-30000, 30000}, 1000);
    };
    CoverageLook from = look(mesh, sector(t), sector(r), 0);
    from.farthest = 2500.0 * m;
    from.nearest = 1500.0 * m;
    const auto area =
        [&](double half) {  // 4 L^2 r_T^2 = (L^2 + r_T^2 - r_R^2)^2, linear in x and y on the right
          const double L = 2 * half;
          const glm::dvec2 b = 2.0 * glm::dvec2(double(r.x) - t.x, double(r.y) - t.y);
          const double h = t.z, g = r.z, alpha = L * L + h * h - g * g - glm::dot(b, b) / 4;
          // With x from the foot point of T: 4 L^2 (x^2 + h^2) = (alpha + b . x)^2.
          const double p = 4 * L * L - glm::dot(b, b), along = alpha * glm::length(b) / p,
                       k = p * along * along + alpha * alpha - 4 * L * L * h * h;
          return std::numbers::pi * k / (2 * L * std::sqrt(p));
        };
    const double n = 96;
    const double outer = area(from.farthest) * n / (2 * pi) * std::sin(2 * pi / n),
                 inner = area(from.nearest) * n / pi * std::tan(pi / n), whole = std::pow(16000.0 * m, 2);
    double seen = 0;
    const auto half_path = [&](glm::dvec3 p) {
      return (glm::distance(p, glm::dvec3(t.x, t.y, t.z)) + glm::distance(p, glm::dvec3(r.x, r.y, r.z))) / 2;
    };
    for (const auto& [id, facet] : cover(mesh, {from})) {
      seen += facet.seen.share / 2;
      EXPECT_EQ(facet.shadow.share, 0);
      for (const CoverageCell& cell : facet.cells)
        for (std::uint32_t k = 0; k < cell.count && cell.pings > 0; ++k) {
          EXPECT_LE(half_path(facet.corners[cell.first + k]), from.farthest * (1 + 1e-8));
          EXPECT_GE(half_path(facet.corners[cell.first + k]), from.nearest * (1 - 1e-8));
        }
    }
    // A polygon with slightly uneven corners covers slightly less.
    EXPECT_NEAR(seen * whole, outer - inner, 2e-4 * outer);
    EXPECT_LE(seen * whole, (outer - inner) * (1 + 1e-8));
  }
}

// ---- separate seabed meshes

/// Cuts edges longer than `longest`, with a requested length that depends on the position.
struct Uneven : EdgeRule {
  double longest;
  explicit Uneven(double length) : longest(length) {}
  bool cuts(const BasePoint& a, const BasePoint& b) const override {
    return glm::distance(a.at_m, b.at_m) > longest;
  }
};

/// Returns a mesh whose coordinates are multiples of `by`, so that its edges have midpoints on the grid.
FacetMesh spread(FacetMesh mesh, std::int32_t by) {
  for (GridPoint& p : mesh.vertices) p = {p.x * by, p.y * by, p.z * by};
  return mesh;
}
TubeSet at(TubeSet tubes, std::int32_t by) {
  tubes.apex = {tubes.apex.x * by, tubes.apex.y * by, tubes.apex.z * by};
  return tubes;
}

std::shared_ptr<const SurfaceParts> parted(const FacetMesh& mesh, double longest) {
  std::vector<FacetId> all(mesh.facets.size());
  std::iota(all.begin(), all.end(), 0u);
  RefinedMesh fine = refine(mesh, all, WorldGrid(0, glm::dvec3(0)), Uneven(longest),
                            [](const BasePoint& p) { return p.at_m; }, {.weights = true});
  const auto own = std::make_shared<const FacetMesh>(std::move(fine.mesh));
  return std::make_shared<const SurfaceParts>(SurfaceParts{
      own, std::make_shared<const SceneTree>(*own), 0, std::move(fine.parent), std::move(fine.weights), {}});
}

CoverageEnd end_on(const std::shared_ptr<const SurfaceParts>& seabed, const TubeSet& tubes) {
  CoverageEnd end = look(*seabed->mesh, tubes, 0).tx;
  end.seabed = seabed;
  return end;
}

// Law O3: a seabed that is only cut into parts has the same coverage, for any cuts.
TEST(CoverageOfParts, IsThatOfTheWhole) {
  constexpr std::int32_t by = 1 << 6;
  std::size_t cut = 0;
  for (std::uint64_t seed = 1; seed <= 8 / one_in; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const FacetMesh mesh = spread(scene_of(seed, random), by);
    std::vector<CoverageLook> whole, parts;
    for (std::uint32_t ping = 0; ping < 3; ++ping) {
      const double tilt = seed % 3 == 0 ? 25 : 0;
      const TubeSet tx = at(forward_tubes(place_in(random), 2, 2, 70, 60, tilt), by),
                    rx = at(forward_tubes(place_in(random), 2, 1, 60, 50, tilt), by);
      const auto seabed = parted(mesh, (900 + 300 * ping) * by);
      EXPECT_GT(seabed->mesh->facets.size(), mesh.facets.size());
      whole.push_back(look(mesh, tx, ping));
      parts.push_back({ping, end_on(seabed, tx)});
      if (ping == 1) {  // one look at the mesh itself among the others
        parts.back() = whole.back();
      } else if (ping == 2) {
        whole.back().rx = look(mesh, rx, ping).tx;
        parts.back().rx = end_on(seabed, rx);
      }
    }
    const Shares expected = shares_of(cover(mesh, whole));
    EXPECT_EQ(shares_of(cover(mesh, parts)), expected);
    for (const auto& [facet, shares] : expected) cut += shares.first.size() > 1;
  }
  EXPECT_GT(cut, 10u);
}

/// A seabed at an apparent position. Shares of the covered facet are those of the image, because the map
/// between them is affine on each part.
TEST(CoverageOfParts, OfAnImageIsThatOfTheImage) {
  FacetMesh mesh, image;
  add_square(mesh, 1000, 0);
  add_square(image, 1000, 0);
  for (GridPoint& p : image.vertices) p = {2 * p.x + p.y, 3 * p.y - 500, p.x / 4 - 200};
  const auto own = std::make_shared<const FacetMesh>(image);
  const auto seabed = std::make_shared<const SurfaceParts>(
      SurfaceParts{own, std::make_shared<const SceneTree>(*own), 0, {}, {}, {}});
  const TubeSet tubes = down_tubes({100, 0, 1000}, {-900, 300, 1000}, {-700, 800}, 1000);
  CoverageLook there = look(image, tubes, 0), here{0, end_on(seabed, tubes)};
  const Shares expected = shares_of(cover(image, {there}));
  EXPECT_EQ(shares_of(cover(mesh, {here})), expected);
  ASSERT_EQ(expected.size(), 2u);
  EXPECT_EQ(expected.at(0).first.size(), 2u) << "cut";
  // With a range gate, which is drawn on charts of different units.
  there.farthest = here.farthest = 1500;
  there.nearest = here.nearest = 1250;
  EXPECT_EQ(shares_of(cover(mesh, {here})).size(), shares_of(cover(image, {there})).size());
}

// Law D5.
TEST(PartWeights, OfAPartOfAPartAreExact) {
  constexpr std::int64_t w = whole_weight;
  const PartWeights corner{{{0, 0}, {w / 2, 0}, {0, w / 2}}},
      middle{{{w / 2, 0}, {w / 2, w / 2}, {0, w / 2}}};
  EXPECT_EQ(part_of_part(all_of_it, middle), middle);
  EXPECT_EQ(part_of_part(middle, all_of_it), middle);
  EXPECT_EQ(part_of_part(corner, middle), (PartWeights{{{w / 4, 0}, {w / 4, w / 4}, {0, w / 4}}}));
  EXPECT_EQ(part_of_part(middle, corner), (PartWeights{{{w / 2, 0}, {w / 2, w / 4}, {w / 4, w / 4}}}));
  // The finest parts.
  constexpr std::int64_t fine = std::int64_t{1} << deepest_refinement;
  const PartWeights least{{{0, 0}, {fine, 0}, {0, fine}}};
  EXPECT_EQ(part_of_part(least, least), (PartWeights{{{0, 0}, {1, 0}, {0, 1}}}));
}

}  // namespace
}  // namespace tubefoot
