// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <boost/multiprecision/gmp.hpp>

#include "engine/gradient/echo_gradient.hpp"
#include "engine/gradient/named_vectors.hpp"
#include "geometry/numbers/ball_vector.hpp"

// Positions of points for values of a parameter. Heavy: include only in .cpp files.
namespace tubefoot {

using ExactNumber =
    boost::multiprecision::number<boost::multiprecision::gmp_rational, boost::multiprecision::et_off>;

/// Positions of the points of a scene by one parameter, relative to the apex: vertices in grid units, rays in
/// the unit of their integers.
class SceneMotion {
 public:
  /// The arguments must outlive this object.
  SceneMotion(const NameContext& context, const EchoParameter& parameter, double unit_m)
      : context_(context), parameter_(parameter), points_(context, unit_m), unit_m_(unit_m) {}

  bool moves(PointId id) const;
  /// Returns whether two points have the same displacement for all values of the parameter.
  bool move_alike(PointId a, PointId b) const;
  /// Upper bound of the displacement of a point by steps up to `step`.
  double reach(PointId id, double step) const;
  /// Encloses the positions and velocities for all values in an interval.
  std::array<MovingBall, 3> enclosure(PointId id, const Ball& value) const;
  /// Position `number` of a sequence of different positions, exactly. Number 0 is that of the value 0. The
  /// coordinates are polynomials of degree 1 in the number, or for rotations quotients of degree 2.
  std::array<ExactNumber, 3> sample(PointId id, int number) const;

 private:
  const NameContext& context_;
  const EchoParameter& parameter_;
  NamedPoints points_;
  double unit_m_;
};

/// Number of samples at which a predicate must vanish to vanish for all values of the parameter. Predicates
/// are polynomials in at most 20 factors that contain one moved point each. For rotations, their degree is
/// at most twice this number.
constexpr int identity_samples = 41;

}  // namespace tubefoot
