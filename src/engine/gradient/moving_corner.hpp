// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <utility>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/numbers/ball_vector.hpp"

// Velocities of corners and planes in ball arithmetic. They are the derivatives of CornerVelocity
// (corner_derivatives.hpp), enclosed. Lengths of vertices are grid units. Heavy: include only in .cpp files.
namespace tubefoot {

/// A ball that carries the enclosure of its derivative through every operation.
struct MovingBall {
  Ball at, by;

  MovingBall operator-() const { return {-at, -by}; }
  friend MovingBall operator+(const MovingBall& a, const MovingBall& b) { return {a.at + b.at, a.by + b.by}; }
  friend MovingBall operator-(const MovingBall& a, const MovingBall& b) { return {a.at - b.at, a.by - b.by}; }
  friend MovingBall operator*(const MovingBall& a, const MovingBall& b) {
    return {a.at * b.at, a.by * b.at + a.at * b.by};
  }
  friend MovingBall operator/(const MovingBall& a, const MovingBall& b) {
    const Ball quotient = a.at / b.at;
    return {quotient, (a.by - quotient * b.by) / b.at};
  }
};
using MovingVector = std::array<MovingBall, 3>;

class MovingNames {
 public:
  /// `velocity`: of a point relative to the apex, per unit of the parameter. `context` must outlive this
  /// object.
  MovingNames(const NameContext& context, std::function<BallVector(PointId)> velocity)
      : context_(context), velocity_(std::move(velocity)) {}

  /// The plane normal . x = offset of a facet. The offset is positive.
  struct Plane {
    MovingVector normal;
    MovingBall offset;
  };
  Plane plane(FacetId facet) const;
  /// The unit normal away from the apex, and the distance from the apex.
  Plane unit_plane(FacetId facet) const;
  MovingVector corner(const CornerName& corner, const Plane& plane) const;

 private:
  MovingVector point(PointId id) const;
  MovingVector normal(const PlaneName& name) const;

  const NameContext& context_;
  std::function<BallVector(PointId)> velocity_;
};

}  // namespace tubefoot
