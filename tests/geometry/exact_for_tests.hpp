// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Exact_rational.h>

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "geometry/visibility/visibility.hpp"

// Rational geometry for oracles, from the specification (the documented meaning of names, tubes and facets)
// and without the kernel's own arithmetic. Slow and plain.
namespace tubefoot::test {

using Q = CGAL::Exact_rational;
using V3 = std::array<Q, 3>;

inline V3 vec(GridPoint p) { return {Q(p.x), Q(p.y), Q(p.z)}; }
inline V3 minus(const V3& a, const V3& b) { return {Q(a[0] - b[0]), Q(a[1] - b[1]), Q(a[2] - b[2])}; }
inline V3 times(const Q& s, const V3& a) { return {Q(s * a[0]), Q(s * a[1]), Q(s * a[2])}; }
inline V3 vector_product(const V3& a, const V3& b) {
  return {Q(a[1] * b[2] - a[2] * b[1]), Q(a[2] * b[0] - a[0] * b[2]), Q(a[0] * b[1] - a[1] * b[0])};
}
inline Q scalar_product(const V3& a, const V3& b) { return Q(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]); }
inline int sign_of(const Q& q) { return q > 0 ? 1 : q < 0 ? -1 : 0; }

/// A facet relative to the apex: its vertices in the order that makes their determinant positive, and its
/// plane n . x = c with c > 0.
struct SeenFrom {
  std::array<V3, 3> vertex;
  std::array<V3, 3>
      inward;  ///< normals of the edge planes; the facet's directions are on their positive side
  V3 n;
  Q c;
};

/// Nothing if the apex lies in the facet's plane.
inline std::optional<SeenFrom> seen_from(const FacetMesh& mesh, FacetId f, GridPoint apex) {
  SeenFrom s;
  for (int k = 0; k < 3; ++k) s.vertex[k] = minus(vec(mesh.vertices[mesh.facets[f][k]]), vec(apex));
  s.c = scalar_product(s.vertex[0], vector_product(s.vertex[1], s.vertex[2]));
  if (s.c == 0) return {};
  if (s.c < 0) {
    std::swap(s.vertex[1], s.vertex[2]);
    s.c = -s.c;
  }
  s.n = vector_product(minus(s.vertex[1], s.vertex[0]), minus(s.vertex[2], s.vertex[0]));
  for (int k = 0; k < 3; ++k) s.inward[k] = vector_product(s.vertex[k], s.vertex[(k + 1) % 3]);
  return s;
}

/// Normal of the plane on whose positive side j is nearer than i.
inline V3 nearer_side(const SeenFrom& i, const SeenFrom& j) {
  return minus(times(i.c, j.n), times(j.c, i.n));
}

inline bool same_plane(const SeenFrom& i, const SeenFrom& j) { return nearer_side(i, j) == V3{0, 0, 0}; }

/// The direction that a corner's names stand for (names.hpp).
inline V3 direction_of(const FacetMesh& mesh, GridPoint apex, const TubeVisibility& seen,
                       const CornerName& corner) {
  const auto point = [&](PointId id) {
    return id & ray_bit ? vec(seen.rays.at(id & ~ray_bit)) : minus(vec(mesh.vertices.at(id)), vec(apex));
  };
  if (corner.point != no_point) return point(corner.point);
  const auto normal = [&](const PlaneName& plane) {
    if (!plane.depth) return vector_product(point(plane.a), point(plane.b));
    return nearer_side(seen_from(mesh, plane.a, apex).value(), seen_from(mesh, plane.b, apex).value());
  };
  return times(corner.sign, vector_product(normal(corner.p), normal(corner.q)));
}

using Cone = std::vector<V3>;  ///< a convex cone by its corners, turning as a tube's rays

inline Cone cone_of(const FacetMesh& mesh, GridPoint apex, const TubeVisibility& seen,
                    const NamedPiece& piece) {
  Cone cone;
  for (std::uint32_t k = 0; k < piece.count; ++k)
    cone.push_back(direction_of(mesh, apex, seen, seen.corners.at(piece.first + k)));
  return cone;
}

inline Cone cone_of(const TubeSet& tubes, std::uint32_t tube) {
  Cone cone;
  for (const std::uint32_t ray : tubes.tubes.at(tube)) cone.push_back(vec(tubes.rays[ray]));
  return cone;
}

inline std::vector<V3> walls_of(const Cone& cone) {
  std::vector<V3> walls;
  for (std::size_t k = 0; k < cone.size(); ++k)
    walls.push_back(vector_product(cone[k], cone[(k + 1) % cone.size()]));
  return walls;
}

/// Sutherland and Hodgman (1974), on directions: the part with normal . d >= 0. A non-convex polygon comes
/// out with doubled edges, which enclose no area.
inline Cone clipped(const Cone& cone, const V3& normal) {
  Cone result;
  for (std::size_t k = 0; k < cone.size(); ++k) {
    const V3 &a = cone[k], &b = cone[(k + 1) % cone.size()];
    const Q sa = scalar_product(normal, a), sb = scalar_product(normal, b);
    if (sa >= 0) result.push_back(a);
    if ((sa > 0 && sb < 0) || (sa < 0 && sb > 0)) {
      const V3 d = minus(times(sb, a), times(sa, b));  // on the plane, on the far side of 0 if sb < 0
      result.push_back(sb < 0 ? times(-1, d) : d);
    }
  }
  return result;
}

inline Cone clipped(Cone cone, const std::vector<V3>& walls) {
  for (const V3& wall : walls) cone = clipped(cone, wall);
  return cone;
}

/// The plane axis . x = 1 with coordinates of its own: areas in it are compared as rationals.
class GnomonicPlane {
 public:
  using Point = std::pair<Q, Q>;

  explicit GnomonicPlane(V3 axis) : axis_(std::move(axis)) {
    for (int k = 1; k < 3; ++k)
      if (CGAL::abs(axis_[k]) > CGAL::abs(axis_[dropped_])) dropped_ = k;
  }

  Point point(const V3& d) const {
    const Q w = scalar_product(axis_, d);
    if (w <= 0) throw std::domain_error("a direction beyond the horizon of the gnomonic plane");
    // The two coordinates kept, in the order that keeps the turning sense.
    const int u = (dropped_ + 1) % 3, v = (dropped_ + 2) % 3;
    const Point p{Q(d[u] / w), Q(d[v] / w)};
    return axis_[dropped_] > 0 ? p : Point{p.second, p.first};
  }

  std::vector<Point> polygon(const Cone& cone) const {
    std::vector<Point> points;
    for (const V3& d : cone) points.push_back(point(d));
    return points;
  }

  /// Twice the area.
  static Q area(const std::vector<Point>& p) {
    Q sum = 0;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const Point &a = p[k], &b = p[(k + 1) % p.size()];
      sum += a.first * b.second - b.first * a.second;
    }
    return sum;
  }
  Q area(const Cone& cone) const { return area(polygon(cone)); }

 private:
  V3 axis_;
  int dropped_ = 0;
};

/// A direction that every direction of a tube makes an acute angle with: the sum of its inward wall normals.
inline V3 axis_of(const Cone& tube) {
  V3 axis{0, 0, 0};
  for (const V3& wall : walls_of(tube))
    for (int k = 0; k < 3; ++k) axis[k] += wall[k];
  return axis;
}

}  // namespace tubefoot::test
