// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Surface integrals of waves from an apex to a plane and on to an apex, as integrals along the edges of a
// polygon. The derivation is in docs/notes/smooth-surfaces.md.

#include <complex>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "geometry/integrals/path_cut.hpp"

namespace tubefoot {

/// Angle, about the apex's foot point, of the part of the circle of slant range `range_m` that lies in the
/// polygon. The result is in radians, at most 2 pi, and negative for the opposite orientation of the
/// polygon. It is 0 for ranges that do not reach the plane. The polygon need not be convex.
/// Law Q3 (arcs): its integral times r dr over ranges is the area.
double arc_angle(const PlanarPolygon& polygon, double range_m);

/// (1/4 pi) times the integral over a polygon of the derivative of F(r + s) / (r s) along the plane's normal
/// towards the apexes. F is e^{ikP} or any sum of such terms. The distances of a point from the transmitter
/// and the receiver are r and s. Both apexes lie on the same side of the plane and may coincide.
///
/// Let D be the distance from one apex to the image of the other. With P = r + s and the angle psi about the
/// line from apex to image the integral is
///   (1/4 pi) closed integral of [ (2/D) F(D) - w F(P) ] dpsi,   w = (D^2 - (r - s)^2) / (2 D r s),
/// exactly, near or far. No term is singular, wherever the line meets the plane.
/// Law Q4 (image): a polygon that covers the whole plane has F(D) / D.
/// Law Q5 (reciprocity): the two apexes may be exchanged.
class EdgeForm {
 public:
  /// Values of F, `count` of them (by wave number or time), for a path in metres.
  using Wave = std::function<void(double path_m, std::span<std::complex<double>> values)>;

  /// `growth_per_m`: F is an analytic function of the path P everywhere, and at most e^{growth |Im P|} times
  /// a constant. For e^{ikP} the growth is k. EdgeForm also evaluates F at paths slightly below the shortest
  /// one.
  EdgeForm(Wave wave, std::size_t count, double growth_per_m);

  /// Adds the contribution of the polygon, which need not be convex. `polygon.distance` is the distance of
  /// the transmitter. For an apex in the plane nothing is added. The result is accurate to some 1e-14 of F
  /// over the shortest path of the plane. If that path is far from the polygon, the polygon's own shortest
  /// path applies.
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
