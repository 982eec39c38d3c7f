// SPDX-License-Identifier: GPL-3.0-or-later
// Compares derivatives of edge panels with central differences of the edge form of one frequency.
#include "geometry/integrals/edge_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>

#include "fixtures/geometry/plane_polygons.hpp"
#include "geometry/integrals/edge_form.hpp"

namespace tubefoot {
namespace {

using test::planar;
using test::Polygon2;
using Complex = std::complex<double>;

/// A polygon and both apexes, whose positions are functions of a parameter.
struct MovingPolygon {
  Polygon2 polygon;
  double height;
  PathCutter::Receiver rx;
  EdgeMotion::Velocity velocity;

  MovingPolygon at(double parameter) const {
    MovingPolygon moved = *this;
    for (std::size_t k = 0; k < polygon.size(); ++k) moved.polygon[k] += parameter * velocity.corners[k];
    moved.height += parameter * velocity.distance;
    moved.rx.distance += parameter * velocity.rx_distance;
    moved.rx.foot += parameter * velocity.rx_foot;
    return moved;
  }
  Complex pressure(double k) const {
    Complex all = 0;
    EdgeForm form([k](double path, std::span<Complex> values) { values[0] = std::polar(1.0, k * path); }, 1,
                  k);
    form.add(planar(polygon, height), rx, std::span(&all, 1));
    return all;
  }
  /// Returns the derivative of the pressure, by panels.
  Complex rate(double k) const {
    const PlanarPolygon planar_polygon = planar(polygon, height);
    EdgePanels edges;
    edges.assign(planar_polygon, rx, k, 0.05);
    const EdgeMotion motion(planar_polygon, rx);
    const double shortest = edges.shortest_m(), by_shortest = motion.of_shortest_m(velocity);
    Complex all =
        edges.image() * (Complex(0, k) - 1 / shortest) * by_shortest * std::polar(1.0, k * shortest);
    std::vector<EdgePanels::Node> nodes;
    for (const EdgePanels::Panel& panel : edges.panels()) {
      nodes.clear();
      edges.nodes(panel, panel.from, panel.to, 0, 1e-15, nodes);
      for (const EdgePanels::Node& node : nodes) {
        const EdgeMotion::NodeRate by = motion.of_node(edges.corner_of(panel), node, velocity);
        all += (by.weight + node.weight * Complex(0, k) * by.path_m) * std::polar(1.0, k * node.path_m);
      }
    }
    return all;
  }
};

TEST(EdgeMotion, EqualsCentralDifferencesOfTheEdgeForm) {
  const unsigned seed = 23;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto signed_unit = [&] { return 2 * unit(random) - 1; };
  for (int n = 0; n < 60; ++n) {
    const double height = 0.3 + 3 * unit(random), k = 20 + 200 * unit(random),
                 size = std::pow(10, -1 + unit(random));
    MovingPolygon moving{test::random_convex(random, {2 * signed_unit(), 2 * signed_unit()}, size, size / 2),
                         height,
                         n % 2 == 0
                             ? PathCutter::Receiver{height, {0, 0}}
                             : PathCutter::Receiver{0.3 + 3 * unit(random), {unit(random), signed_unit()}},
                         {}};
    for (std::size_t c = 0; c < moving.polygon.size(); ++c)
      moving.velocity.corners.emplace_back(signed_unit(), signed_unit());
    moving.velocity.distance = signed_unit();
    moving.velocity.rx_distance = signed_unit();
    moving.velocity.rx_foot = {signed_unit(), signed_unit()};
    const double step = 1e-4 / k;
    const Complex difference = (8.0 * (moving.at(step).pressure(k) - moving.at(-step).pressure(k)) -
                                (moving.at(2 * step).pressure(k) - moving.at(-2 * step).pressure(k))) /
                               (12 * step);
    EXPECT_NEAR(std::abs(moving.rate(k) - difference), 0, 1e-8 * std::abs(difference) + 1e-9 * k) << n;
  }
}

TEST(EdgeMotion, RigidMotionChangesNothing) {
  const unsigned seed = 24;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int n = 0; n < 20; ++n) {
    MovingPolygon moving{test::random_convex(random, {unit(random), -unit(random)}, 0.5, 0.3),
                         1.2,
                         {0.7, {unit(random), unit(random)}},
                         {}};
    // A rotation about the foot point of the transmit apex.
    for (const glm::dvec2 corner : moving.polygon) moving.velocity.corners.emplace_back(-corner.y, corner.x);
    moving.velocity.rx_foot = {-moving.rx.foot.y, moving.rx.foot.x};
    const double k = 100;
    EXPECT_NEAR(std::abs(moving.rate(k)), 0, 1e-11 * k) << n;
  }
}

}  // namespace
}  // namespace tubefoot
