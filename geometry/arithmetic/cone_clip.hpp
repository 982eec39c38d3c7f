// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "geometry/mesh/names.hpp"

// Clips convex cones by planes through their apex, with any arithmetic (concept: arithmetic_fixed.hpp). Signs
// that follow from the names of points and planes are decided without arithmetic.
namespace tubefoot {

/// A plane with its name. The code refers to a plane by its address while it computes a tube.
template <class A>
struct ClipPlane {
  typename A::Plane plane;
  PlaneName name;
  GridPoint points[2];  ///< the points of the names a and b, for planes through two points
};

/// A side of a plane: the half-space sign * normal . d >= 0.
template <class A>
struct Half {
  const ClipPlane<A>* plane = nullptr;
  int sign = 1;
};

/// A corner of a cone, with the half-space whose plane bounds the cone from this corner to the next one.
template <class A>
struct ClipCorner {
  typename A::Corner corner;
  PointId point = no_point;
  Half<A> p, q;  ///< if the corner is not a point: direction sign_p n_p x sign_q n_q
  Half<A> edge;
};

/// Convex cones in one growing buffer. A piece is a range of this buffer.
template <class A>
using CornerBuffer = std::vector<ClipCorner<A>>;

struct PieceRange {
  std::uint32_t first = 0, count = 0;
  friend bool operator==(const PieceRange&, const PieceRange&) = default;
};

/// Writes the corner at an input point to `c`.
template <class A>
void point_corner(const A& arithmetic, PointId id, GridPoint direction, Half<A> edge, ClipCorner<A>& c) {
  arithmetic.point(c.corner, direction);
  c.point = id;
  c.edge = edge;
}

/// Computes the corner at which a cone turns from half-space p to half-space q. Two planes through the same
/// point meet in the ray of that point or in the opposite ray. The sign of a determinant of three input
/// points distinguishes the two.
template <class A>
void meet(const A& arithmetic, Half<A> p, Half<A> q, Half<A> edge, ClipCorner<A>& c) {
  c.edge = edge;
  c.p = p;
  c.q = q;
  if constexpr (A::uses_names) {
    const PlaneName &np = p.plane->name, &nq = q.plane->name;
    if (!np.depth && !nq.depth) {
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
          const PointId id = i == 0 ? np.a : np.b;
          if (id != (j == 0 ? nq.a : nq.b)) continue;
          // (V x W) x (V x U) = V det(V, W, U). V x U is the normal of q up to the order of its points.
          const GridPoint v = p.plane->points[i], w = p.plane->points[1 - i];
          const int order = (i == 0 ? 1 : -1) * p.sign * q.sign;
          if (order * arithmetic.side(w, q.plane->plane) * -1 > 0) {
            arithmetic.point(c.corner, v);
            c.point = id;
            return;
          }
          arithmetic.meet(c.corner, p.plane->plane, q.plane->plane, p.sign * q.sign);
          return;
        }
    }
  }
  arithmetic.meet(c.corner, p.plane->plane, q.plane->plane, p.sign * q.sign);
}

/// Returns the sign of half . corner when the first stage cannot decide it. Zeros that follow from names are
/// found before any arithmetic.
template <class A>
int ambiguous_side(const A& arithmetic, const ClipCorner<A>& c, Half<A> half) {
  if constexpr (A::uses_names) {
    if (c.point != no_point) {
      if (half.plane->name.contains(c.point)) return 0;
    } else if (c.p.plane->name == half.plane->name || c.q.plane->name == half.plane->name) {
      return 0;
    }
  }
  return half.sign * arithmetic.side(c.corner, half.plane->plane);
}

/// Returns the sign of half . corner. A sign that double certifies is not zero, so the names need no
/// comparison then.
template <class A>
int side(const A& arithmetic, const ClipCorner<A>& c, Half<A> half) {
  if constexpr (requires { arithmetic.double_side(c.corner, half.plane->plane); })
    if (const int s = arithmetic.double_side(c.corner, half.plane->plane)) return half.sign * s;
  return ambiguous_side(arithmetic, c, half);
}

/// Appends the part of `piece` inside `half` to `buffer`. `sides` has one sign per corner, at least one of
/// them positive and one negative. The function accepts every pattern of signs, so that an inexact arithmetic
/// cannot break it.
template <class A>
PieceRange clip(const A& arithmetic, CornerBuffer<A>& buffer, PieceRange piece, Half<A> half,
                const int* sides) {
  PieceRange result{static_cast<std::uint32_t>(buffer.size()), 0};
  if (const std::size_t most = buffer.size() + 2 * piece.count; most > buffer.capacity())
    buffer.reserve(2 * most);
  for (std::uint32_t k = 0; k < piece.count; ++k) {
    const std::uint32_t next = k + 1 == piece.count ? 0 : k + 1;
    const Half<A> edge = buffer[piece.first + k].edge;
    if (sides[k] >= 0) {
      buffer.push_back(buffer[piece.first + k]);
      if (sides[next] < 0) {
        if (sides[k] > 0)
          meet(arithmetic, edge, half, half, buffer.emplace_back());
        else
          buffer.back().edge = half;
      }
    } else if (sides[next] > 0) {
      meet(arithmetic, half, edge, edge, buffer.emplace_back());
    }
  }
  result.count = static_cast<std::uint32_t>(buffer.size()) - result.first;
  return result;
}

}  // namespace tubefoot
