// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_arrival.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "engine/certified/certified_gain.hpp"
#include "geometry/numbers/ball_vector.hpp"

// Encloses the energy of unscattered arrivals, in isovelocity water E = loss B_t B_r 10^(-alpha r / 10) /
// r^2. In stratified water the energy follows from an enclosed ray. The file also encloses products of two
// receivers' signals.
namespace tubefoot {
namespace {

Ball gain(const Directivity& pattern, const BallVector& direction) {
  const CertifiedGain certified(pattern);
  if (certified.is_uniform()) return Ball(1);
  Ball w = dot(balls(pattern.axis), direction);
  if (!(w.lo() >= -1 && w.hi() <= 1)) w = Ball::between(std::max(w.lo(), -1.0), std::min(w.hi(), 1.0));
  const Ball most = certified.largest(), value = certified.at(w, false, most);
  return value.is_finite() ? value : most * Ball::between(0, 1);
}

/// Ball of an energy, which is not negative.
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

void certify_arrival(const Arrival& arrival, const RangeSamples& samples, const TakeArrival& take) {
  const BallVector displacement{Ball(double(arrival.displacement.x)), Ball(double(arrival.displacement.y)),
                                Ball(double(arrival.displacement.z))};
  const Ball units = root(squared(displacement[0]) + squared(displacement[1]) + squared(displacement[2])),
             length = units * Ball(arrival.unit_m),
             beta = Ball(arrival.absorption_db_per_m) * log(Ball(10)) / Ball(10);
  const BallVector direction{displacement[0] / units, displacement[1] / units, displacement[2] / units};
  certify_arrival({length / Ball(2), exp(-(beta * length)) / squared(length), direction, direction}, arrival,
                  true, samples, take);
}

std::optional<EnclosedRay> enclose_ray(const ApparentMap& water, const RayEnclosure& rays,
                                       const glm::dvec3& place_m) {
  const glm::dvec3 displacement = water.unfolded(place_m) - water.apex_m(), u(1, 0, 0), v(0, 1, 0);
  const std::array<Interval, 3> at{displacement.x, displacement.y, displacement.z};
  const auto found = rays.over(at, u, v, 0.0, 0.0);
  if (!found) return std::nullopt;
  const auto ball = [](const Interval& x) { return Ball::between(x.lo, x.hi); };
  const Interval distance2 = squared(at[0]) + squared(at[1]) + squared(at[2]), distance = root(distance2),
                 range = rays.reference_speed_m_s() * found->time_s.v;
  // The areas per steradian in the two directions differ by the square of the ratio of sound speeds at the
  // ends.
  const double ratio = water.water().profile.at(water.depth_m(place_m)) / water.finder().source_speed_m_s(),
               beta = std::numbers::ln10 / 10;
  const Interval area = found->area_ratio_per_sr.v * distance2 * squared(outwards(ratio, ratio, 16)),
                 kept = exp(-(found->absorption_db.v * outwards(beta, beta, 4))),
                 across = found->arrival_across.v / distance;
  const double sign = water.unfolding().sign;
  EnclosedRay ray;
  ray.half_path_m = ball(range * 0.5);
  ray.energy = ball(kept / area);
  ray.sent = {ball(found->image[0].v / range), ball(found->image[1].v / range),
              ball(sign * found->image[2].v / range)};
  ray.arrives = {ball(across * at[0]), ball(across * at[1]),
                 ball(-sign * found->arrival_down_m.v / distance)};
  if (!ray.energy.is_finite() || !ray.half_path_m.is_finite()) return std::nullopt;
  return ray;
}

void certify_arrival(const EnclosedRay& ray, const Arrival& arrival, bool sure, const RangeSamples& samples,
                     const TakeArrival& take) {
  const BallVector &direction = ray.sent, back{-ray.arrives[0], -ray.arrives[1], -ray.arrives[2]};
  const MirrorLoss& loss = arrival.leg->loss;
  Ball energy = Ball(loss.factor) * ray.energy;
  Ball exponent;
  for (const glm::dvec3& normal : loss.rough_normals) {
    const Ball sine2 = squared(dot(balls(normal), direction));
    exponent += loss.bend == 0 ? sine2 : Ball(1) - Ball(1 + loss.bend) * (Ball(1) - sine2);
  }
  energy = energy * exp(-(Ball(loss.roughness) * exponent));
  if (!sure) energy = Ball(std::max(energy.hi(), 0.0)) * Ball::between(0, 1);
  if (arrival.transmit != nullptr) {
    BallVector sent;  // in the frame of the true apex
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
  const Ball& half = ray.half_path_m;
  for (std::size_t sample = 0; sample + 1 < borders.size(); ++sample) {
    if (half.hi() < borders[sample] || half.lo() >= borders[sample + 1]) continue;
    const bool surely = half.lo() >= borders[sample] && half.hi() < borders[sample + 1];
    for (std::size_t beam = 0; beam < std::max<std::size_t>(arrival.receive.size(), 1); ++beam) {
      Ball received = arrival.receive.empty() ? energy : energy * gain(arrival.receive[beam], back);
      if (!surely) received = Ball(std::max(received.hi(), 0.0)) * Ball::between(0, 1);
      const double middle = std::max(received.middle(), 0.0);
      const Ball off = received - Ball(middle);
      take(beam, sample, middle, std::max({off.hi(), -off.lo(), 0.0}));
    }
  }
}

std::array<Bounded, 2> certify_arrivals_product(const GridPoint& displacement, double unit_m,
                                                const ReceiverBaseline& receiver_pair, const Bounded& upper,
                                                const Bounded& lower) {
  const std::array<double, 3> units{double(displacement.x), double(displacement.y), double(displacement.z)};
  Ball along, to_upper, to_lower;
  for (std::size_t k = 0; k < 3; ++k) {
    const Ball middle = Ball(units[k]) * Ball(unit_m),
               half = Ball(receiver_pair.baseline_m) / Ball(2) * Ball(receiver_pair.axis[int(k)]);
    along += middle * half;
    to_upper += squared(middle + half);
    to_lower += squared(middle - half);
  }
  // (upper^2 - lower^2) / (upper + lower)
  const Ball further = Ball(4) * along / (root(to_upper) + root(to_lower)),
             size = root(ball_of(upper) * ball_of(lower));
  Ball sine, cosine;
  sin_cos(Ball(receiver_pair.wavenumber_rad_m) * further, sine, cosine);
  return {bounded(size * cosine), bounded(size * sine)};
}

}  // namespace tubefoot
