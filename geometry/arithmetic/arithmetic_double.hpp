// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "geometry/mesh/facet_cone.hpp"

namespace tubefoot {

/// Plain floating-point arithmetic, the baseline for comparisons. A value counts as zero if it lies within
/// `tolerance`, relative to the lengths of its factors. With tolerance 0 every sign is taken as computed. Not
/// exact. Concept: arithmetic_fixed.hpp.
struct DoubleArithmetic {
  static constexpr bool uses_names = true;
  static constexpr bool signs_are_exact = false;
  double tolerance = 0;

  struct Facet {
    double n[3], c, length;
  };
  struct Plane {
    double n[3], length;
  };
  struct Corner {
    double v[3], length;
  };

  void through(Plane& plane, GridPoint a, GridPoint b) const {
    plane.n[0] = double(a.y) * b.z - double(a.z) * b.y;
    plane.n[1] = double(a.z) * b.x - double(a.x) * b.z;
    plane.n[2] = double(a.x) * b.y - double(a.y) * b.x;
    plane.length = norm(plane.n);
  }
  void depth(Plane& plane, const Facet& i, const Facet& j) const {
    for (int k = 0; k < 3; ++k) plane.n[k] = i.c * j.n[k] - j.c * i.n[k];
    plane.length = norm(plane.n);
  }
  void facet(Facet& f, const FacetCone& cone) const {
    const auto& [a, b, c] = cone.point;
    const double p[3] = {double(b.x) - a.x, double(b.y) - a.y, double(b.z) - a.z};
    const double q[3] = {double(c.x) - a.x, double(c.y) - a.y, double(c.z) - a.z};
    f.n[0] = p[1] * q[2] - p[2] * q[1];
    f.n[1] = p[2] * q[0] - p[0] * q[2];
    f.n[2] = p[0] * q[1] - p[1] * q[0];
    f.c = f.n[0] * a.x + f.n[1] * a.y + f.n[2] * a.z;
    f.length = norm(f.n);
  }
  void point(Corner& corner, GridPoint d) const {
    corner.v[0] = d.x;
    corner.v[1] = d.y;
    corner.v[2] = d.z;
    corner.length = norm(corner.v);
  }
  void meet(Corner& corner, const Plane& p, const Plane& q, int sign) const {
    corner.v[0] = sign * (p.n[1] * q.n[2] - p.n[2] * q.n[1]);
    corner.v[1] = sign * (p.n[2] * q.n[0] - p.n[0] * q.n[2]);
    corner.v[2] = sign * (p.n[0] * q.n[1] - p.n[1] * q.n[0]);
    corner.length = norm(corner.v);
  }
  int side(const Corner& corner, const Plane& plane) const {
    return signum(corner.v[0] * plane.n[0] + corner.v[1] * plane.n[1] + corner.v[2] * plane.n[2],
                  corner.length * plane.length);
  }
  int side(GridPoint p, const Plane& plane) const {
    const double v[3] = {double(p.x), double(p.y), double(p.z)};
    return signum(v[0] * plane.n[0] + v[1] * plane.n[1] + v[2] * plane.n[2], norm(v) * plane.length);
  }
  int nearer(const Facet& f, GridPoint p) const {
    const double v[3] = {double(p.x), double(p.y), double(p.z)};
    return signum(f.c - (f.n[0] * v[0] + f.n[1] * v[1] + f.n[2] * v[2]), norm(v) * f.length);
  }

 private:
  int signum(double d, double scale) const {
    const double zero = tolerance * scale;
    return d > zero ? 1 : d < -zero ? -1 : 0;
  }
  static double norm(const double* v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }
};

}  // namespace tubefoot
