// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that several intervals of edges in lanes give the same bits as each interval alone. The lanes
// compute integrals over range bins by Green's theorem.
#include "geometry/integrals/range_lanes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <glm/geometric.hpp>
#include <random>
#include <utility>
#include <vector>

#include "geometry/integrals/range_cut.hpp"

namespace tubefoot {
namespace {

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

/// Nodes and weights in the order of the sums.
struct Rule {
  std::vector<double> x, weight;
  template <unsigned n>
  static Rule of() {
    using Gauss = boost::math::quadrature::gauss<double, n>;
    Rule rule;
    for (std::size_t i = 0; i < Gauss::abscissa().size(); ++i)
      for (const double sign : {1.0, -1.0}) {
        if (sign < 0 && Gauss::abscissa()[i] == 0) continue;
        rule.x.push_back(sign * Gauss::abscissa()[i]);
        rule.weight.push_back(Gauss::weights()[i]);
      }
    return rule;
  }
};

/// Expected result of one interval in the lanes, from Green's theorem (range_cut.hpp).
struct Alone {
  double angle = 0, inside = 0;
  Alone(const EdgeWalk& w, double from, double step, const RadialIntegral& radial, std::size_t cell,
        const Rule& rule) {
    const double half = w.direction * step / 2, centre = from + half;
    for (std::size_t i = 0; i < rule.x.size(); ++i) {
      const double along = centre + half * rule.x[i], at = w.start + along;
      const double turned = step / 2 * (rule.weight[i] * w.height / (w.height2 + at * at));
      const double reach_x = along * w.along.x, reach_y = along * w.along.y;
      const double gain =
          ((w.from_nearest_point.x + reach_x) * (w.from_foot.x + reach_x + w.nearest_from_foot.x) +
           (w.from_nearest_point.y + reach_y) * (w.from_foot.y + reach_y + w.nearest_from_foot.y)) /
              (std::sqrt(w.range2 + at * at) + w.near_range) -
          (radial.cells()[cell].lo - w.near_range);
      angle += turned;
      inside += turned * radial.from_front(cell).over(gain);
    }
  }
};

EdgeWalk some_walk(std::mt19937_64& random) {
  std::uniform_real_distribution<double> place(-20, 20), turn(-3, 3);
  const double azimuth = turn(random), distance = 8 + std::abs(place(random));
  EdgeWalk walk;
  walk.direction = turn(random) < 0 ? -1 : 1;
  walk.along = {std::cos(azimuth), std::sin(azimuth)};
  walk.from_foot = {place(random), place(random)};
  walk.start = glm::dot(walk.from_foot, walk.along);
  walk.height = walk.from_foot.x * walk.along.y - walk.from_foot.y * walk.along.x;
  walk.height2 = walk.height * walk.height;
  walk.range2 = distance * distance + walk.height2;
  walk.nearest_from_foot = {place(random) / 4, place(random) / 4};
  walk.from_nearest_point = walk.from_foot - walk.nearest_from_foot;
  walk.near_range = std::sqrt(distance * distance + glm::dot(walk.nearest_from_foot, walk.nearest_from_foot));
  return walk;
}

TEST(RangeLanes, StretchesTogetherHaveTheBitsOfEachAlone) {
  const std::uint64_t seed = 20261124;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  std::mt19937_64 random(seed);
  std::vector<double> borders;
  // near intervals are cut and of high degree
  for (int k = 0; k <= 200; ++k) borders.push_back(2 + 0.3 * k);
  const RadialIntegral radial(borders, [](double r) { return std::pow(r, -6) * std::exp(-0.02 * r); });
  ASSERT_GT(radial.cells().size(), most_stretches);
  const std::array rules{Rule::of<3>(), Rule::of<4>(), Rule::of<5>(), Rule::of<8>()};
  std::uniform_real_distribution<double> length(0, 0.4);
  for (std::size_t count = 1; count <= most_stretches; ++count)
    for (const Rule& rule : rules) {
      const EdgeWalk walk = some_walk(random);
      const std::size_t cell = random() % (radial.cells().size() - count + 1);
      std::vector<double> y{length(random) * 10}, step(count), angle(count), inside(count);
      for (std::size_t k = 0; k < count; ++k) {
        step[k] = length(random);
        y.push_back(y[k] + walk.direction * step[k]);
      }
      const CellsOfStretches cells = radial.cells_from(cell, count);
      EXPECT_EQ(cells.lo[0], radial.cells()[cell].lo);
      integrate_stretches(walk, count, y.data(), step.data(), cells,
                          {rule.x.size(), rule.x.data(), rule.weight.data()}, angle.data(), inside.data());
      for (std::size_t k = 0; k < count; ++k) {
        const Alone alone(walk, y[k], step[k], radial, cell + k, rule);
        ASSERT_EQ(bits(angle[k]), bits(alone.angle)) << k << " of " << count << ", " << rule.x.size();
        ASSERT_EQ(bits(inside[k]), bits(alone.inside)) << k << " of " << count << ", " << rule.x.size();
      }
    }
}

TEST(RangeLanes, DistancesToBordersAreThoseOfEachAlone) {
  std::vector<double> borders, out(100);
  for (int k = 0; k < 100; ++k) borders.push_back(3 + 0.07 * k);
  const double range = 4.2;
  for (std::size_t count = 0; count <= 100; ++count) {
    distances_to_borders(range, count, borders.data(), out.data());
    for (std::size_t k = 0; k < count; ++k)
      ASSERT_EQ(bits(out[k]), bits(std::sqrt(std::max((borders[k] - range) * (borders[k] + range), 0.0))));
  }
}

// The limits of range_cut.cpp: n nodes have an error of about (step / 2 distance)^2n. No interval is longer
// than half of the distance.
TEST(RangeLanes, LongerStretchesTakeMoreNodesAndTheLongestMoreThanOneQuadrature) {
  EdgeWalk walk;
  walk.height = 3;
  walk.height2 = 9;
  walk.start = 4;  // 5 from the foot point
  const std::array<std::pair<double, double>, 9> cases{{{0, 0},
                                                        {0.0299, 3},
                                                        {0.0301, 4},
                                                        {0.149, 4},
                                                        {0.151, 5},
                                                        {0.399, 5},
                                                        {0.401, 8},
                                                        {2.49, 8},
                                                        {3.2, 0}}};
  for (const double direction : {1.0, -1.0})
    for (const auto& [length, expected] : cases) {
      const std::array<double, 2> y{0, direction * length};
      double step = -1, nodes = -1;
      nodes_of_stretches(walk, 1, y.data(), &step, &nodes);
      EXPECT_EQ(nodes, expected) << length;
      if (expected > 0) {
        EXPECT_EQ(step, length);
      }
    }
  // No small rest at the end: a little more than half of the distance is one quadrature.
  const std::array<double, 2> y{0, 2.6};
  double step = -1, nodes = -1;
  nodes_of_stretches(walk, 1, y.data(), &step, &nodes);
  EXPECT_EQ(nodes, 8);
  EXPECT_EQ(step, 2.6);
}

}  // namespace
}  // namespace tubefoot
