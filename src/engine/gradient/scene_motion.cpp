// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/scene_motion.hpp"

#include <glm/geometric.hpp>

// Rotations by an angle use the formula of Rodrigues. Exact samples use that of Cayley, in which the tangent
// of half the angle is the number of the sample.

namespace tubefoot {

bool SceneMotion::moves(PointId id) const {
  if (parameter_.turn) return parameter_.turn->axis != glm::dvec3(0) && parameter_.turn->moves(id);
  return parameter_.velocity && parameter_.velocity(id, points_.point(id)) != glm::dvec3(0);
}

bool SceneMotion::move_alike(PointId a, PointId b) const {
  if (!moves(a) && !moves(b)) return true;
  if (parameter_.turn || ((a ^ b) & ray_bit)) return false;
  return parameter_.velocity(a, points_.point(a)) == parameter_.velocity(b, points_.point(b));
}

double SceneMotion::reach(PointId id, double step) const {
  if (parameter_.turn && !moves(id)) return 0;
  const glm::dvec3 at = points_.point(id);
  const double speed = parameter_.turn
                           ? glm::length(parameter_.turn->axis) * glm::length(at - parameter_.turn->origin_m)
                           : glm::length(parameter_.velocity(id, at));
  return speed * step / (id & ray_bit ? 1 : unit_m_) * (1 + 1e-12);
}

std::array<MovingBall, 3> SceneMotion::enclosure(PointId id, const Ball& value) const {
  const GridPoint p = context_.point(id);
  std::array<MovingBall, 3> at{MovingBall{Ball(p.x), Ball()}, MovingBall{Ball(p.y), Ball()},
                               MovingBall{Ball(p.z), Ball()}};
  if (!moves(id)) return at;
  const Ball unit(id & ray_bit ? 1 : unit_m_);
  if (!parameter_.turn) {
    const BallVector v = balls(parameter_.velocity(id, points_.point(id)));
    for (std::size_t k = 0; k < 3; ++k) {
      at[k].by = v[k] / unit;
      at[k].at += value * at[k].by;
    }
    return at;
  }
  const BallVector axis = balls(parameter_.turn->axis), origin = balls(parameter_.turn->origin_m);
  const Ball rate = root(dot(axis, axis));
  BallVector unit_axis, x;
  for (std::size_t k = 0; k < 3; ++k) {
    unit_axis[k] = axis[k] / rate;
    x[k] = at[k].at - origin[k] / unit;
  }
  Ball sine, cosine;
  sin_cos(rate * value, sine, cosine);
  const BallVector across = cross(unit_axis, x);
  const Ball along = dot(unit_axis, x);
  for (std::size_t k = 0; k < 3; ++k) {
    const Ball beside = x[k] - unit_axis[k] * along;
    at[k].at += (cosine - Ball(1)) * beside + sine * across[k];
    at[k].by = rate * (cosine * across[k] - sine * beside);
  }
  return at;
}

std::array<ExactNumber, 3> SceneMotion::sample(PointId id, int number) const {
  using Vector = std::array<ExactNumber, 3>;
  const GridPoint p = context_.point(id);
  const Vector at{p.x, p.y, p.z};
  if (number == 0 || !moves(id)) return at;
  const auto exact = [](glm::dvec3 v) { return Vector{v.x, v.y, v.z}; };
  const ExactNumber unit(id & ray_bit ? 1 : unit_m_);
  Vector moved;
  if (!parameter_.turn) {
    const Vector v = exact(parameter_.velocity(id, points_.point(id)));
    for (std::size_t k = 0; k < 3; ++k) moved[k] = at[k] + number * v[k] / unit;
    return moved;
  }
  const Vector axis = exact(parameter_.turn->axis), origin = exact(parameter_.turn->origin_m);
  Vector x;
  for (std::size_t k = 0; k < 3; ++k) x[k] = at[k] - origin[k] / unit;
  const Vector across = cross(axis, x);
  const ExactNumber square = number * number * dot(axis, axis), along = number * number * dot(axis, x);
  for (std::size_t k = 0; k < 3; ++k)
    moved[k] = at[k] + 2 * (along * axis[k] - square * x[k] + number * across[k]) / (1 + square);
  return moved;
}

}  // namespace tubefoot
