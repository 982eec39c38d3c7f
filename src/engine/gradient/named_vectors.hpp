// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <boost/functional/hash.hpp>
#include <functional>
#include <unordered_map>
#include <utility>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/mesh/facet_cone.hpp"
#include "geometry/numbers/ball.hpp"
#include "geometry/numbers/interval.hpp"
#include "geometry/numbers/vector_products.hpp"

// Vectors that names denote, for points that move. The number type is a ball, a rational, or
// an enclosure with its derivative. Heavy: include only in .cpp files.
namespace tubefoot {

/// An enclosure that carries the enclosure of its derivative through every operation.
template <class Enclosure>
struct Moving {
  Enclosure at, by;

  friend Moving operator+(const Moving& a, const Moving& b) { return {a.at + b.at, a.by + b.by}; }
  friend Moving operator-(const Moving& a, const Moving& b) { return {a.at - b.at, a.by - b.by}; }
  friend Moving operator*(const Moving& a, const Moving& b) {
    return {a.at * b.at, a.by * b.at + a.at * b.by};
  }
  friend Moving operator/(const Moving& a, const Moving& b) {
    const Enclosure quotient = a.at / b.at;
    return {quotient, (a.by - quotient * b.by) / b.at};
  }
};
using MovingBall = Moving<Ball>;
using MovingInterval = Moving<Interval>;
/// Returns the square root of a positive number.
inline MovingBall root(const MovingBall& x) {
  const Ball value = root(x.at);
  return {value, x.by / (Ball(2) * value)};
}

/// The vectors of names for one position of all points. The object keeps each vector that it has computed.
template <class N>
class NamedVectors {
 public:
  using Vector = std::array<N, 3>;
  /// The plane normal . x = offset of a facet, with the orientation of its FacetCone.
  struct Plane {
    Vector normal;
    N offset;
  };

  /// `position`: of a point relative to the apex. Lengths of vertices have one unit, and each ray has its
  /// own. `context` must outlive this object.
  NamedVectors(const NameContext& context, std::function<Vector(PointId)> position)
      : context_(context), position_(std::move(position)) {}

  const Vector& point(PointId id) {
    const auto [place, is_new] = points_.try_emplace(id);
    if (is_new) place->second = position_(id);
    return place->second;
  }
  const Plane& plane(FacetId facet) {
    const auto [place, is_new] = planes_.try_emplace(facet);
    if (is_new) {
      FacetCone cone;
      FacetCone::make(context_.mesh, facet, context_.apex, cone);
      const Vector &a = point(cone.vertex[0]), &b = point(cone.vertex[1]), &c = point(cone.vertex[2]);
      place->second.normal = cross(difference(b, a), difference(c, a));
      place->second.offset = dot(place->second.normal, a);
    }
    return place->second;
  }
  const Vector& normal(const PlaneName& name) {
    const auto [place, is_new] =
        normals_.try_emplace(std::array<std::uint32_t, 3>{name.a, name.b, name.depth});
    if (is_new) {
      if (!name.depth) {
        place->second = cross(point(name.a), point(name.b));
      } else {
        const Plane &one = plane(name.a), &other = plane(name.b);
        place->second = difference(product(one.offset, other.normal), product(other.offset, one.normal));
      }
    }
    return place->second;
  }
  /// Returns a vector along the ray of a corner.
  Vector ray(const CornerName& corner) {
    if (corner.point != no_point) return point(corner.point);
    return corner.sign < 0 ? cross(normal(corner.q), normal(corner.p))
                           : cross(normal(corner.p), normal(corner.q));
  }

  static Vector difference(const Vector& a, const Vector& b) {
    return {N(a[0] - b[0]), N(a[1] - b[1]), N(a[2] - b[2])};
  }
  static Vector product(const N& factor, const Vector& v) {
    return {N(factor * v[0]), N(factor * v[1]), N(factor * v[2])};
  }

 private:
  const NameContext& context_;
  std::function<Vector(PointId)> position_;
  std::unordered_map<PointId, Vector> points_;
  std::unordered_map<FacetId, Plane> planes_;
  std::unordered_map<std::array<std::uint32_t, 3>, Vector, boost::hash<std::array<std::uint32_t, 3>>>
      normals_;
};

}  // namespace tubefoot
