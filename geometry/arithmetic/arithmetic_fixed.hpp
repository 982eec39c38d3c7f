// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/numbers/lane_bits.hpp"
#include "geometry/numbers/wide_int.hpp"

// Defines the Arithmetic concept and its default model. An arithmetic provides three types and the predicates
// on them. No other part of the kernel computes with numbers.
//
// clang-format off
//   Plane                   a plane through the apex
//     through(plane, a, b)    with normal a x b
//     depth(plane, i, j)      with normal c_i n_j - c_j n_i
//   Corner                  a ray from the apex
//     point(corner, d)        in the direction d
//     meet(corner, p, q, s)   in the direction s * (n_p x n_q)
//   Facet                   the plane n . x = c of a facet
//     facet(f, cone)
//   side(corner, plane)     sign of normal . direction
//   side(point, plane)      the same for an input point
//   nearer(facet, point)    sign of c - n . point: +1 on the apex's side
//   uses_names              whether zeros that follow from names alone need no arithmetic
//   signs_are_exact         whether all signs are those of the exact values
// An arithmetic with a fast first stage also provides these members of the default model:
//   double_side(), FourHalves, double_sides()
// clang-format on
//
// Law A1 (cyclic): side(meet(p, q), r) = side(meet(q, r), p) = side(meet(r, p), q).
//
// Law A2 (antisymmetric): side(meet(q, p), r) = side(meet(p, r), q) = -side(meet(p, q), r).
//
// Law A3 (turning): side(meet(p, q), r) changes sign with each normal, and with s.
//
// Law A4 (own planes): side(meet(p, q), p) = side(meet(p, q), q) = 0.
//
// Law A5 (points): side(d, through(a, b)) is the sign of det(a, b, d), for a point d and for a corner d.
//
// Law A6 (nearer): nearer(facet, d) is the sign of c - n . d, which is 0 for the facet's own vertices.
//
// Law A7 (depth): depth(j, i) = -depth(i, j). The planes depth(i, j), depth(j, k) and depth(k, i) meet in one
// line. For a vertex d of i beyond the plane of j, side(d, depth(i, j)) = -nearer(j, d), which is 0 for a
// common vertex.
//
// Law A8 (one sign): all exact arithmetics, and each of their stages by itself, return the same signs.
//
// Law A9 (bounds): a value in double differs from the exact value by at most the error bound stored with it.
//
// Law A10 (budget): no integer overflows for coordinates of up to 2^30 (docs/notes/bit-budget.md).
namespace tubefoot {

/// 64-bit normals with a filter in double. A predicate returns the sign of a double that exceeds its error
/// bound. Otherwise it computes with 128- and 192-bit integers, or with 512-bit integers if a depth plane is
/// involved. Exact; allocates no memory.
struct FixedArithmetic {
  static constexpr bool uses_names = true;
  static constexpr bool signs_are_exact = true;
  static constexpr double u = std::numeric_limits<double>::epsilon() / 2;

  struct Facet {
    const FacetCone* cone = nullptr;
    double n[3], c;
  };

  struct Plane {
    double n[3];
    double size = 0;                             ///< bound on the magnitude of each coordinate of n
    double error = 0;                            ///< bound on the error of each coordinate of n
    Vec64 exact;                                 ///< for planes through two points
    const FacetCone *i = nullptr, *j = nullptr;  ///< for depth planes: c_i n_j - c_j n_i
  };

  struct Corner {
    double v[3];
    double size = 0, error = 0;
    const Plane *p = nullptr, *q = nullptr;  ///< null for an input point
    GridPoint point;
    int sign = 1;
  };

  /// Up to four half-spaces, stored side by side for vector instructions.
  struct FourHalves {
    struct Two {
      std::array<TwoDoubles, 3> n{};
      TwoDoubles size{}, rounding{};  ///< terms of the error bounds of the first stage
    };
    std::array<Two, 2> two;

    void set(std::size_t k, const Plane& plane, int sign) {
      Two& pair = two[k / 2];
      for (std::size_t c = 0; c < 3; ++c) pair.n[c][k % 2] = sign * plane.n[c];
      pair.size[k % 2] = plane.size;
      pair.rounding[k % 2] = plane.error + 4 * u * plane.size;
    }
  };
  /// Bit k: certainly inside half-space k. Bit 4 + k: certainly outside. Neither bit: undecided, or
  /// half-space k is not set.
  using FourSides = unsigned;

  void through(Plane& plane, GridPoint a, GridPoint b) const {
    plane.exact = cross(a, b);
    plane.n[0] = static_cast<double>(plane.exact.x);
    plane.n[1] = static_cast<double>(plane.exact.y);
    plane.n[2] = static_cast<double>(plane.exact.z);
    plane.size = largest(plane.n);
    plane.error = u * plane.size;
    plane.i = plane.j = nullptr;
  }

  void depth(Plane& plane, const Facet& i, const Facet& j) const {
    double products = 0;
    for (int k = 0; k < 3; ++k) {
      const double p = i.c * j.n[k], q = j.c * i.n[k];
      plane.n[k] = p - q;
      products = std::max(products, std::abs(p) + std::abs(q));
    }
    // The error bound counts one rounding of each factor, one of each product and one of the difference.
    plane.error = 5 * u * products;
    plane.size = largest(plane.n) + plane.error;
    plane.i = i.cone;
    plane.j = j.cone;
  }

  void facet(Facet& f, const FacetCone& cone) const {
    f.cone = &cone;
    f.n[0] = static_cast<double>(cone.normal.x);
    f.n[1] = static_cast<double>(cone.normal.y);
    f.n[2] = static_cast<double>(cone.normal.z);
    f.c = static_cast<double>(cone.offset);
  }

  void point(Corner& corner, GridPoint d) const {
    corner.v[0] = d.x;
    corner.v[1] = d.y;
    corner.v[2] = d.z;
    corner.size = largest(corner.v);
    corner.error = 0;
    corner.p = corner.q = nullptr;
    corner.point = d;
    corner.sign = 1;
  }

  void meet(Corner& corner, const Plane& p, const Plane& q, int sign) const {
    corner.v[0] = sign * (p.n[1] * q.n[2] - p.n[2] * q.n[1]);
    corner.v[1] = sign * (p.n[2] * q.n[0] - p.n[0] * q.n[2]);
    corner.v[2] = sign * (p.n[0] * q.n[1] - p.n[1] * q.n[0]);
    // The error bound counts two products of rounded factors and the rounding of their difference. The factor
    // 10 covers second-order terms.
    corner.error =
        2.01 * (p.size * q.error + q.size * p.error + p.error * q.error) + 10 * u * p.size * q.size;
    corner.size = largest(corner.v) + corner.error;
    corner.p = &p;
    corner.q = &q;
    corner.sign = sign;
  }

  int side(const Corner& corner, const Plane& plane) const {
    const int s = double_side(corner, plane);
    return s != 0 ? s : exact_side(corner, plane);
  }
  int side(GridPoint p, const Plane& plane) const {
    const int s = double_side(p, plane);
    return s != 0 ? s : exact_side(p, plane);
  }
  int nearer(const Facet& f, GridPoint p) const {
    const int s = double_nearer(f, p);
    return s != 0 ? s : exact_nearer(f, p);
  }

  /// The first stage: returns the sign if the double exceeds its error bound, otherwise 0.
  int double_side(const Corner& corner, const Plane& plane) const {
    const double d = corner.v[0] * plane.n[0] + corner.v[1] * plane.n[1] + corner.v[2] * plane.n[2];
    const double bound =
        3.01 * (corner.error * plane.size + corner.size * (plane.error + 4 * u * plane.size));
    return beyond(d, bound);
  }
  int double_side(GridPoint p, const Plane& plane) const {
    const double x = p.x, y = p.y, z = p.z;
    const double d = x * plane.n[0] + y * plane.n[1] + z * plane.n[2];
    const double bound =
        (std::abs(x) + std::abs(y) + std::abs(z)) * (1.01 * plane.error + 4 * u * plane.size);
    return beyond(d, bound);
  }
  int double_nearer(const Facet& f, GridPoint p) const {
    const double x = p.x * f.n[0], y = p.y * f.n[1], z = p.z * f.n[2];
    const double d = f.c - (x + y + z);
    return beyond(d, 8 * u * (std::abs(x) + std::abs(y) + std::abs(z) + f.c));
  }

  /// The first stage for four half-spaces at once: double_side() of a corner or of a point for each of them.
  FourSides double_sides(const Corner& corner, const FourHalves& halves) const {
    return double_sides(corner.v[0], corner.v[1], corner.v[2], corner.size, corner.error, halves);
  }
  FourSides double_sides(GridPoint p, const FourHalves& halves) const {
    const double x = p.x, y = p.y, z = p.z;
    return double_sides(x, y, z, std::max({std::abs(x), std::abs(y), std::abs(z)}), 0, halves);
  }

  /// The last stage, which computes with integers only. The tests of the filter use it as reference.
  static int exact_side(const Corner& corner, const Plane& plane);
  static int exact_side(GridPoint p, const Plane& plane);
  static int exact_nearer(const Facet& f, GridPoint p) {
    return sign(f.cone->offset - dot(f.cone->normal, p));
  }

 private:
  static FourSides double_sides(double x, double y, double z, double size, double error,
                                const FourHalves& halves) {
    const auto sides = [&](const FourHalves::Two& h) {
      const TwoDoubles d = x * h.n[0] + y * h.n[1] + z * h.n[2];
      const TwoDoubles bound = 3.01 * (error * h.size + size * h.rounding);
      return bits_of(TwoLanes(d > bound)) | bits_of(TwoLanes(d < -bound)) << 4;
    };
    return sides(halves.two[0]) | sides(halves.two[1]) << 2;
  }
  static int beyond(double d, double bound) { return d > bound ? 1 : d < -bound ? -1 : 0; }
  static double largest(const double* v) {
    return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
  }
};

}  // namespace tubefoot
