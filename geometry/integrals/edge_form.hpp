// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "geometry/integrals/path_cut.hpp"

// Surface integrals of waves that go from an apex to a plane and from there to an apex, as integrals along a
// polygon's edges. docs/smooth-surfaces.md has the derivation.
namespace tubefoot {

/// The angle, about the apex's foot point, of the circle of slant range `range_m` that lies in the polygon:
/// radians, at most 2 pi, negative for a polygon that turns the other way, 0 for ranges that do not reach the
/// plane. The polygon need not be convex.
/// Law Q3 (arcs): its integral times r dr over ranges is the area.
double arc_angle(const PlanarPolygon& polygon, double range_m);

/// (1/4 pi) times the integral over a polygon of the derivative, along the plane's normal towards the apexes,
/// of F(r + s) / (r s) where F is e^{ikP} or any sum of such: r and s are the distances of a place from the
/// apex of the transmit leg and from that of the receive leg, which lie on the same side of the plane. One
/// apex is the case where both are one.
///
/// With D the distance from the one apex to the other's image, P = r + s and psi the angle about the line
/// from apex to image it is
///     (1/4 pi) closed integral of [ (2/D) F(D) - w F(P) ] dpsi,   w = (D^2 - (r - s)^2) / (2 D r s),
/// exactly, near or far. Nothing of it is singular, wherever the line meets the plane.
/// Law Q4 (image): a polygon that holds all of the plane has F(D) / D.
/// Law Q5 (reciprocity): the ends may be exchanged.
class EdgeForm {
 public:
  /// Values of F, `count` of them (of wave numbers, of times), for a path [m].
  using Wave = std::function<void(double path_m, std::span<std::complex<double>> values)>;

  /// `growth_per_m`: F is an analytic function of the path P everywhere, no larger than some
  /// e^{growth |Im P|}: for e^{ikP}, k. It is also asked of paths that are a little too short.
  EdgeForm(Wave wave, std::size_t count, double growth_per_m);

  /// Adds the polygon's part. `polygon.distance` is that of the transmit leg's apex. An apex in the plane
  /// sees it from the edge: nothing is added. Polygons need not be convex. Accurate to some 1e-14 of F over
  /// the distance of the plane's place of shortest path (of the polygon, where that place is far from it).
  void add(const PlanarPolygon& polygon, const PathCutter::Receiver& rx, std::span<std::complex<double>> out);
  /// The same for one apex.
  void add(const PlanarPolygon& polygon, std::span<std::complex<double>> out) {
    add(polygon, {polygon.distance, glm::dvec2(0)}, out);
  }

 private:
  struct Plane;
  struct Edge;
  void add(const Plane& plane, const Edge& edge, double from, double to, int halvings,
           std::span<std::complex<double>> out);

  void expand(double shortest);

  Wave wave_;
  double growth_per_m_;
  std::vector<std::complex<double>> values_;
  // F about the shortest path D, in Newton's form: [F(D)], [F(D + width x) - F(D)] / x by orders of x.
  std::vector<std::complex<double>> at_shortest_, quotient_;
  double width_ = 0;
};

}  // namespace tubefoot
