// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the parts of the overlay: the table of lines, residues, borders of unions, and the division into
// cells. The comparisons are rationals, which evaluate each definition directly.
#include "geometry/footprints/coverage_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "fixtures/geometry/coverage_oracle.hpp"
#include "fixtures/geometry/grid_scenes.hpp"
#include "geometry/footprints/facet_regions.hpp"
#include "geometry/footprints/line_areas.hpp"

namespace tubefoot {
namespace {

using test::Poly;
using test::Q;

PlaneLine line_of(std::int64_t a, std::int64_t b, std::int64_t c) {
  return PlaneLine::of(HugeInt(a), HugeInt(b), HugeInt(c));
}

/// Small coefficients, so that many lines are equal, parallel or concurrent.
std::array<std::int64_t, 3> small_line(test::Random& random) {
  std::array<std::int64_t, 3> line{};
  while (line[0] == 0 && line[1] == 0)
    for (std::int64_t& x : line) x = test::uniform(random, -3, 3);
  return line;
}

int sign_of_number(std::int64_t x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

TEST(LineTable, EqualLinesHaveOneNumberAndPredicatesAreThoseOfRationals) {
  test::Random random(7);
  LineTable table;
  std::vector<std::array<std::int64_t, 3>> all;
  std::vector<DirectedLine> number;
  for (int k = 0; k < 60; ++k) {
    all.push_back(small_line(random));
    const std::int64_t scale = test::uniform(random, 1, 1000000);
    number.push_back(table.keep(line_of(scale * all[k][0], scale * all[k][1], scale * all[k][2])));
  }
  std::size_t equal_lines = 0, concurrent = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < all.size(); ++j) {
      const auto &p = all[i], &q = all[j];
      const std::int64_t turn = p[0] * q[1] - p[1] * q[0];
      const bool same = turn == 0 && p[0] * q[2] == p[2] * q[0] && p[1] * q[2] == p[2] * q[1];
      const bool opposite = p[0] * q[0] + p[1] * q[1] < 0;
      EXPECT_EQ(number[i].line == number[j].line, same);
      if (same) {
        EXPECT_EQ(number[i].opposite == number[j].opposite, !opposite);
      }
      equal_lines += same && i != j;
      const int flip = number[i].opposite == number[j].opposite ? 1 : -1;
      EXPECT_EQ(table.turn(number[i].line, number[j].line), flip * sign_of_number(turn));
      if (turn == 0) continue;
      const LineCorner corner = table.corner(number[i].line, number[j].line);
      for (std::size_t k = 0; k < all.size(); ++k) {
        const auto& r = all[k];
        const std::int64_t det =
            turn * r[2] + (p[1] * q[2] - p[2] * q[1]) * r[0] + (p[2] * q[0] - p[0] * q[2]) * r[1];
        const int side = sign_of_number(det) * sign_of_number(turn) * (number[k].opposite ? -1 : 1);
        EXPECT_EQ(table.side(corner, number[k].line), side);
        concurrent += det == 0 && k != i && k != j;
        const std::int64_t other = p[0] * r[1] - p[1] * r[0];
        if (other == 0) continue;
        // Positions along (b, -a) of the stored line i.
        const auto place = [&](const auto& by, std::int64_t cross) {
          const Q u = Q(p[1] * by[2] - p[2] * by[1]) / Q(cross),
                  v = Q(p[2] * by[0] - p[0] * by[2]) / Q(cross);
          return Q((number[i].opposite ? -1 : 1) * (Q(p[1]) * u - Q(p[0]) * v));
        };
        const Q difference = place(q, turn) - place(r, other);
        EXPECT_EQ(table.order(number[i].line, corner, table.corner(number[i].line, number[k].line)),
                  test::sign_of(difference));
      }
    }
  EXPECT_GT(equal_lines, 20u);
  EXPECT_GT(concurrent, 1000u);
}

/// Returns a convex polygon of random lines around a square, with corners between grid points.
std::optional<TabledPolygon> random_polygon(test::Random& random, LineTable& table) {
  const std::int32_t u = test::uniform(random, -40, 40), v = test::uniform(random, -40, 40),
                     half = test::uniform(random, 3, 25);
  LineStore store;
  LinePolygon polygon;
  for (const auto& [a, b] : {std::pair{0, 1}, {-1, 0}, {0, -1}, {1, 0}})
    polygon.push_back(store.keep(line_of(a, b, half - a * u - b * v)));
  std::vector<int> sides;
  for (int k = 0; k < 3 && !polygon.empty(); ++k) {
    const auto [a, b, c] = small_line(random);
    clip(polygon, *store.keep(line_of(a, b, c * 7 - a * u - b * v)), sides);
  }
  if (polygon.empty()) return std::nullopt;
  TabledPolygon result;
  for (const PlaneLine* line : polygon) result.lines.push_back(table.keep(*line));
  for (std::size_t k = 0; k < result.lines.size(); ++k)
    result.corners.push_back(
        table.corner(result.lines[k == 0 ? result.lines.size() - 1 : k - 1], result.lines[k]));
  return result;
}

Poly rational_polygon(const LineTable& table, std::span<const DirectedLine> lines) {
  const auto q = [](const HugeInt& x) { return Q(x.str()); };
  Poly polygon;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const PlaneLine p = table.exact(lines[k == 0 ? lines.size() - 1 : k - 1].line),
                    n = table.exact(lines[k].line);
    const Q w = q(HugeInt(p.a * n.b - p.b * n.a));
    polygon.push_back({q(HugeInt(p.b * n.c - p.c * n.b)) / w, q(HugeInt(p.c * n.a - p.a * n.c)) / w});
  }
  return polygon;
}

TabledPolygon frame(LineTable& table, std::int64_t half) {
  TabledPolygon polygon;
  for (const auto& [a, b] : {std::pair{0, 1}, {-1, 0}, {0, -1}, {1, 0}})
    polygon.lines.push_back(table.keep(line_of(a, b, half)));
  for (std::size_t k = 0; k < 4; ++k)
    polygon.corners.push_back(table.corner(polygon.lines[(k + 3) % 4], polygon.lines[k]));
  return polygon;
}

TEST(LineAreas, ResiduesAreThoseOfTheFraction) {
  test::Random random(11);
  LineTable table;
  const Integer prime(residue_prime);
  for (int k = 0; k < 200; ++k) {
    const auto polygon = random_polygon(random, table);
    if (!polygon) continue;
    const Fraction area = reduced(double_area(table, polygon->lines));
    const Q rational = test::doubled_area(rational_polygon(table, polygon->lines));
    EXPECT_EQ(Q(area.numerator.str()) / Q(area.denominator.str()), rational);
    // The residue times the denominator is the numerator.
    const Integer residue(double_area_residue(table, polygon->lines));
    EXPECT_EQ(Integer((residue * area.denominator - area.numerator) % prime), 0);
  }
}

TEST(LayerBorder, SharedEdgesCancel) {
  LineTable table;
  LayerBorder border;
  // A chessboard without gaps: 6 x 5 rectangles, every second row moved by half a rectangle.
  for (int row = 0; row < 5; ++row)
    for (int column = 0; column < 6; ++column) {
      const int left = 10 * column + (row % 2) * 5, right = column == 5 ? 60 : left + 10;
      const int from = column == 0 ? 0 : left;
      TabledPolygon polygon;
      for (const PlaneLine& line : {line_of(0, 1, -4 * row), line_of(-1, 0, right),
                                    line_of(0, -1, 4 * row + 4), line_of(1, 0, -from)})
        polygon.lines.push_back(table.keep(line));
      for (std::size_t k = 0; k < 4; ++k)
        polygon.corners.push_back(table.corner(polygon.lines[(k + 3) % 4], polygon.lines[k]));
      border.add(polygon);
    }
  border.finish(table);
  EXPECT_EQ(border.edges().size(), 4u);
}

/// The areas by number of layers are those of inclusion and exclusion.
TEST(CoverageCells, AreThoseOfInclusionAndExclusion) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Random random(seed);
    LineTable table;
    std::vector<CoverageLayer> layers;
    std::vector<std::vector<Poly>> sets;
    for (std::uint32_t ping = 0; ping < 5; ++ping) {
      CoverageLayer layer{ping, ping, {}, false, {}};
      // Disjoint polygons, as the areas of the oracle require.
      sets.emplace_back();
      for (int k = 0; k < 12; ++k) {
        const auto polygon = random_polygon(random, table);
        if (!polygon) continue;
        const Poly own = rational_polygon(table, polygon->lines);
        const bool overlaps = std::ranges::any_of(
            sets.back(), [&](const Poly& other) { return test::doubled_area(test::meet(other, own)) != 0; });
        if (overlaps) continue;
        sets.back().push_back(own);
        layer.border.add(*polygon);
        if (k % 2 == 0) layer.border.add(*polygon);  // the same again counts once
      }
      layer.border.finish(table);
      layers.push_back(std::move(layer));
    }
    const CoverageCells cells = divided_by_borders(table, frame(table, 200), layers);
    std::map<std::uint32_t, Q> found;
    Residue total = 0;
    for (const CoverageCell& cell : cells.cells) {
      const auto lines = std::span(cells.lines).subspan(cell.first, cell.count);
      found[cell.pings] += test::doubled_area(rational_polygon(table, lines));
      total = residue_sum(total, double_area_residue(table, lines));
      EXPECT_EQ(cell.in_sector, 0u);
    }
    EXPECT_EQ(total, Residue{2 * 400 * 400});
    const std::vector<Q> expected = test::areas_by_count(sets);
    for (std::uint32_t k = 1; k < expected.size(); ++k) EXPECT_EQ(found[k], expected[k]) << k << " layers";
  }
}

TEST(CoverageCells, PointInAThinCellIsExact) {
  LineTable table;
  // Between v >= 0 and 10^15 v <= u + 1, the cell is thinner than the rounding of its coordinates.
  TabledPolygon thin;
  for (const PlaneLine& line : {line_of(0, 1, 0), line_of(-1, 0, 1), line_of(1, -1000000000000000, 1)})
    thin.lines.push_back(table.keep(line));
  for (std::size_t k = 0; k < 3; ++k)
    thin.corners.push_back(table.corner(thin.lines[(k + 2) % 3], thin.lines[k]));
  const InnerPoint point(table, thin);
  EXPECT_FALSE(point.is_near_exact());
  for (const DirectedLine& line : thin.lines) EXPECT_EQ(point.side(table, line.line), line.opposite ? -1 : 1);
  LayerBorder border;
  border.add(thin);
  border.finish(table);
  EXPECT_TRUE(border.contains(table, point));
}

}  // namespace
}  // namespace tubefoot
