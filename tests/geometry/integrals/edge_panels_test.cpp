// SPDX-License-Identifier: GPL-3.0-or-later
// Compares edges that are divided into panels over path lengths with the edge form of one frequency, also
// near the point of the shortest path.
#include "geometry/integrals/edge_panels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>

#include "fixtures/geometry/plane_polygons.hpp"
#include "geometry/integrals/edge_form.hpp"
#include "geometry/integrals/polygon_transform.hpp"

namespace tubefoot {
namespace {

using test::planar;
using test::Polygon2;
using Complex = std::complex<double>;

struct EdgePanelsTest : testing::Test {
  EdgePanels edges;

  void assign(const Polygon2& polygon, double height, const PathCutter::Receiver& rx, double k,
              double most_spread_m) {
    edges.assign(planar(polygon, height), rx, k, most_spread_m);
  }
  Complex sum(double k, double error) const {
    Complex all = edges.image() * phasor(k * edges.shortest_m());
    std::vector<EdgePanels::Node> nodes;
    for (const EdgePanels::Panel& panel : edges.panels())
      edges.nodes(panel, panel.from, panel.to, 0, error, nodes);
    for (const EdgePanels::Node& node : nodes) all += node.weight * phasor(k * node.path_m);
    return all;
  }
  static Complex by_edge_form(const Polygon2& polygon, double height, const PathCutter::Receiver& rx,
                              double k) {
    Complex all = 0;
    EdgeForm form([k](double path, std::span<Complex> values) { values[0] = phasor(k * path); }, 1, k);
    form.add(planar(polygon, height), rx, std::span(&all, 1));
    return all;
  }
};

TEST_F(EdgePanelsTest, HaveTheEdgeFormOfOneFrequency) {
  const unsigned seed = 11;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int n = 0; n < 60; ++n) {
    const double height = 0.3 + 3 * unit(random), k = 20 + 400 * unit(random),
                 size = std::pow(10, -2 + 2 * unit(random));
    const PathCutter::Receiver rx =
        n % 2 == 0 ? PathCutter::Receiver{height, {0, 0}}
                   : PathCutter::Receiver{0.3 + 3 * unit(random), {unit(random), unit(random) - 0.5}};
    const Polygon2 polygon =
        test::random_convex(random, {2 * unit(random) - 1, 2 * unit(random) - 1}, size, size / 2);
    assign(polygon, height, rx, k, n % 3 == 0 ? 10.0 : 0.05);
    const double reached = 1 / edges.shortest_m();
    EXPECT_LT(std::abs(sum(k, 1e-12) - by_edge_form(polygon, height, rx, k)), 1e-11 * reached) << n;
    EXPECT_LT(std::abs(sum(k, 1e-4) - by_edge_form(polygon, height, rx, k)), 1e-4 * reached) << n;
  }
}

// The cases are an edge through the point of the shortest path, edges at smaller and smaller distances from
// it, and a corner on it.
TEST_F(EdgePanelsTest, HaveItWhereAnEdgeMeetsTheShortestPath) {
  const double height = 1.3, k = 200;
  for (const PathCutter::Receiver& rx : {PathCutter::Receiver{height, {0, 0}}, {0.9, {0.4, -0.2}}}) {
    const glm::dvec2 c = rx.foot * (height / (height + rx.distance));
    for (const double beside : {0.0, 1e-17, 1e-15, -1e-13, 1e-9, -1e-6, 1e-3}) {
      const Polygon2 polygon{c + glm::dvec2(-0.4, beside), c + glm::dvec2(0.7, beside),
                             c + glm::dvec2(0.2, 0.5)};
      assign(polygon, height, rx, k, 0.05);
      EXPECT_LT(std::abs(sum(k, 1e-12) - by_edge_form(polygon, height, rx, k)), 1e-10 / edges.shortest_m())
          << beside;
    }
    const Polygon2 corner{c, c + glm::dvec2(0.5, 0.1), c + glm::dvec2(0.1, 0.6)};
    assign(corner, height, rx, k, 0.05);
    EXPECT_LT(std::abs(sum(k, 1e-12) - by_edge_form(corner, height, rx, k)), 1e-10 / edges.shortest_m());
  }
}

TEST_F(EdgePanelsTest, PathsAreFoundWhereTheyAre) {
  assign({{-0.4, -0.3}, {0.9, -0.2}, {0.1, 0.7}}, 1.1, {0.8, {0.2, 0.3}}, 100, 0.02);
  EXPECT_GT(edges.panels().size(), 20u);
  for (const EdgePanels::Panel& panel : edges.panels()) {
    EXPECT_LE(panel.most_path_m() - panel.least_path_m(), 0.02);
    for (const double share : {0.0, 1e-9, 0.3, 0.9, 1.0}) {
      const double path = panel.from_path_m + share * (panel.to_path_m - panel.from_path_m),
                   at = edges.place_of(panel, path);
      ASSERT_GE(at, panel.from);
      ASSERT_LE(at, panel.to);
      // Nodes before the point have shorter or longer paths, by the direction of the panel. Nodes after it
      // have the others. Some nodes lie next to it.
      const double sign = panel.to_path_m > panel.from_path_m ? 1 : -1;
      const double step = 1e-6 * (panel.to - panel.from);
      std::vector<EdgePanels::Node> before, after;
      edges.nodes(panel, std::max(panel.from, at - step), at, 0, 1e-9, before);
      edges.nodes(panel, at, std::min(panel.to, at + step), 0, 1e-9, after);
      for (const EdgePanels::Node& node : before) {
        EXPECT_LE((node.path_m - path) * sign, 1e-14);
        EXPECT_NEAR(node.path_m, path, 3 * step);
      }
      for (const EdgePanels::Node& node : after) EXPECT_GE((node.path_m - path) * sign, -1e-14);
    }
  }
}

TEST_F(EdgePanelsTest, AnApexInThePlaneSeesNothing) {
  assign({{-1, -1}, {1, -1}, {0, 1}}, 0, {1, {0, 0}}, 100, 0.1);
  EXPECT_TRUE(edges.panels().empty());
  EXPECT_EQ(edges.image(), 0);
}

}  // namespace
}  // namespace tubefoot
