// SPDX-License-Identifier: GPL-3.0-or-later
// Compares cells along and across the gradient of the path length with cells about the point of the
// shortest path.
#include "geometry/integrals/compact_path_cut.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "fixtures/geometry/plane_polygons.hpp"

namespace tubefoot {
namespace {

using test::planar;
using test::Polygon2;

std::vector<double> even(double first, double step, int count) {
  std::vector<double> borders;
  for (int k = 0; k <= count; ++k) borders.push_back(first + k * step);
  return borders;
}

/// Lambert's law with absorption, and the same with a pattern that has side lobes.
void echo(glm::dvec2 p, double out, double rx, std::span<double> values) {
  values[0] = std::exp(-0.05 * (out + rx)) / (out * out * out * rx * rx * rx);
  const double at = 20 * (p.x / out - 0.3), lobe = at == 0 ? 1 : std::sin(at) / at;
  values[1] = values[0] * lobe * lobe;
}

enum class Cells { polar, by_size, by_agreement };

std::vector<double> samples(const PlanarPolygon& polygon, const PathCutter::Receiver& receiver,
                            const std::vector<double>& borders, std::size_t values, Cells cells) {
  PathCutter::Work work;
  work.values = values;
  work.tolerance = cells == Cells::polar ? 1e-12 : 1e-10;
  work.resolution_rad = values == 1 ? 1 : 0.08;  // of the lobe, e^(2 * 20 * 0.08 / 2)
  work.analytic = cells == Cells::by_size;
  work.agreements = cells == Cells::polar ? 2 : 1;
  std::vector<double> out(values * (borders.size() - 1), 0);
  PathCutter cutter(borders);
  cutter.add(
      polygon, receiver,
      [&](glm::dvec2 p, double there, double rx, std::span<double> at) {
        double both[2];
        echo(p, there, rx, both);
        std::copy_n(both, values, at.begin());
      },
      work, out);
  return out;
}

void expect_same(std::size_t values, Cells cells, int polygons) {
  const unsigned seed = 2718;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-20, 20), height(0.2, 12);
  for (int i = 0; i < polygons; ++i) {
    const PathCutter::Receiver receiver{height(random), {place(random), place(random)}};
    const double size = i % 3 == 0 ? 0.05 : i % 3 == 1 ? 1 : 12;
    const PlanarPolygon polygon = planar(
        test::random_convex(random, {place(random), place(random)}, size, i % 2 == 0 ? size : size / 50),
        height(random));
    const std::vector<double> borders = even(0, i % 3 == 0 ? 0.01 : 0.25, i % 3 == 0 ? 4000 : 320);
    const std::vector<double> expected = samples(polygon, receiver, borders, values, Cells::polar),
                              got = samples(polygon, receiver, borders, values, cells);
    double whole = 0;
    for (std::size_t k = 0; k < got.size(); k += values) whole += expected[k];
    ASSERT_GT(whole, 0);
    // Cells about the shortest path have corners that are accurate to 1e-15 of their distance from its
    // point.
    const double rounding = 1e-15 * 40 * size / area(polygon);
    for (std::size_t k = 0; k < got.size(); k += values)
      for (std::size_t v = k; v < k + values; ++v)
        ASSERT_NEAR(got[v], expected[v], (1e-10 + rounding) * expected[k] + (1e-13 + rounding / 100) * whole)
            << "polygon " << i << ", sample " << k / values << ", value " << v - k;
  }
}

// Law P4.
TEST(CompactPathCut, RulesBySizeAgreeWithCellsAboutTheShortestPath) { expect_same(1, Cells::by_size, 400); }

TEST(CompactPathCut, RulesThatAgreeDoToo) { expect_same(1, Cells::by_agreement, 150); }

TEST(CompactPathCut, PatternsAreResolved) {
  expect_same(2, Cells::by_size, 60);
  expect_same(2, Cells::by_agreement, 30);
}

}  // namespace
}  // namespace tubefoot
