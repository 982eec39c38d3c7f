// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>
#include <vector>

#include "geometry/integrals/measure.hpp"

namespace tubefoot::test {

using Polygon2 = std::vector<glm::dvec2>;

/// Corners, relative to the apex, of a polygon given in its plane's coordinates about the foot point.
inline std::vector<glm::dvec3> on_plane(const FacetPlane& plane, const Polygon2& polygon) {
  const PlaneFrame frame(plane);
  std::vector<glm::dvec3> corners;
  for (const glm::dvec2& p : polygon)
    corners.push_back(-plane.distance_m * plane.normal + p.x * frame.u + p.y * frame.v);
  return corners;
}

inline FacetPlane flat_bed(double height) { return {glm::dvec3(0, 0, 1), height}; }

inline FacetPlane random_plane(std::mt19937_64& random, double distance) {
  std::normal_distribution<double> gauss;
  return {glm::normalize(glm::dvec3{gauss(random), gauss(random), gauss(random)}), distance};
}

/// A convex polygon: points of an ellipse, in increasing angle.
inline Polygon2 random_convex(std::mt19937_64& random, glm::dvec2 centre, double a, double b) {
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  const int n = std::uniform_int_distribution<int>(3, 9)(random);
  std::vector<double> angles;
  for (int i = 0; i < n; ++i) angles.push_back(angle(random));
  std::sort(angles.begin(), angles.end());
  const double turn = angle(random);
  Polygon2 polygon;
  for (double t : angles) {
    const double x = a * std::cos(t), y = b * std::sin(t);
    polygon.push_back(centre + glm::dvec2(x * std::cos(turn) - y * std::sin(turn),
                                          x * std::sin(turn) + y * std::cos(turn)));
  }
  return polygon;
}

inline Polygon2 shifted(Polygon2 polygon, glm::dvec2 by) {
  for (glm::dvec2& p : polygon) p += by;
  return polygon;
}

}  // namespace tubefoot::test
