// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_arrival.hpp"

#include <algorithm>
#include <array>

#include "engine/certified/certified_gain.hpp"

namespace tubefoot {
namespace {

using BallVector = std::array<Ball, 3>;

Ball along(const glm::dvec3& axis, const BallVector& direction) {
  return Ball(axis.x) * direction[0] + Ball(axis.y) * direction[1] + Ball(axis.z) * direction[2];
}

Ball gain(const Directivity& pattern, const BallVector& direction) {
  const CertifiedGain certified(pattern);
  if (certified.is_uniform()) return Ball(1);
  Ball w = along(pattern.axis, direction);
  if (!(w.lo() >= -1 && w.hi() <= 1)) w = Ball::between(std::max(w.lo(), -1.0), std::min(w.hi(), 1.0));
  const Ball most = certified.largest(), value = certified.at(w, false, most);
  return value.is_finite() ? value : most * Ball::between(0, 1);
}

/// An energy: no less than nothing.
Ball ball_of(const Bounded& energy) {
  const Ball bound(energy.bound), middle(energy.value);
  return Ball::between(std::max((middle - bound).lo(), 0.0), (middle + bound).hi());
}

Bounded bounded(const Ball& x) {
  const double middle = x.middle();
  const Ball off = x - Ball(middle);
  return {middle, std::max({off.hi(), -off.lo(), 0.0})};
}

}  // namespace

void certify_arrival(const Arrival& arrival, const RangeSamples& samples,
                     const std::function<void(std::size_t, std::size_t, double, double)>& take) {
  const BallVector way{Ball(double(arrival.way.x)), Ball(double(arrival.way.y)), Ball(double(arrival.way.z))};
  const Ball units = root(squared(way[0]) + squared(way[1]) + squared(way[2])),
             length = units * Ball(arrival.unit_m),
             beta = Ball(arrival.absorption_db_per_m) * log(Ball(10)) / Ball(10);
  const BallVector direction{way[0] / units, way[1] / units, way[2] / units},
      back{-direction[0], -direction[1], -direction[2]};
  const MirrorLoss& loss = arrival.leg->loss;
  Ball energy = Ball(loss.factor) * exp(-(beta * length)) / squared(length);
  Ball exponent;
  for (const glm::dvec3& normal : loss.rough_normals) exponent += squared(along(normal, direction));
  energy = energy * exp(-(Ball(loss.roughness) * exponent));
  if (arrival.transmit != nullptr) {
    BallVector sent;  // as the true apex has it
    for (int row = 0; row < 3; ++row) {
      Ball& one = sent[std::size_t(row)];
      for (int column = 0; column < 3; ++column)
        one += Ball(arrival.leg->to_true[column][row]) * direction[std::size_t(column)];
    }
    Ball all;
    for (const Directivity& beam : arrival.transmit->beams) all += gain(beam, sent);
    energy = energy * all;
  }

  const std::vector<double> borders = sample_borders_m(samples);
  const Ball half = length / Ball(2);
  for (std::size_t sample = 0; sample + 1 < borders.size(); ++sample) {
    if (half.hi() < borders[sample] || half.lo() >= borders[sample + 1]) continue;
    const bool surely = half.lo() >= borders[sample] && half.hi() < borders[sample + 1];
    for (std::size_t beam = 0; beam < std::max<std::size_t>(arrival.receive.size(), 1); ++beam) {
      Ball heard = arrival.receive.empty() ? energy : energy * gain(arrival.receive[beam], back);
      if (!surely) heard = Ball(std::max(heard.hi(), 0.0)) * Ball::between(0, 1);
      const double middle = std::max(heard.middle(), 0.0);
      const Ball off = heard - Ball(middle);
      take(beam, sample, middle, std::max({off.hi(), -off.lo(), 0.0}));
    }
  }
}

std::array<Bounded, 2> certify_arrivals_product(const GridPoint& way, double unit_m, const Fringe& staff,
                                                const Bounded& upper, const Bounded& lower) {
  const std::array<double, 3> units{double(way.x), double(way.y), double(way.z)};
  Ball along, to_upper, to_lower;
  for (std::size_t k = 0; k < 3; ++k) {
    const Ball middle = Ball(units[k]) * Ball(unit_m),
               half = Ball(staff.baseline_m) / Ball(2) * Ball(staff.axis[int(k)]);
    along += middle * half;
    to_upper += squared(middle + half);
    to_lower += squared(middle - half);
  }
  // (upper^2 - lower^2) / (upper + lower)
  const Ball further = Ball(4) * along / (root(to_upper) + root(to_lower)),
             size = root(ball_of(upper) * ball_of(lower));
  Ball sine, cosine;
  sin_cos(Ball(staff.wavenumber_rad_m) * further, sine, cosine);
  return {bounded(size * cosine), bounded(size * sine)};
}

}  // namespace tubefoot
