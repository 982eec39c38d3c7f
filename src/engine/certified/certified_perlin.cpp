// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_perlin.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/numbers/enclosure_slack.hpp"

// Encloses Perlin noise with the fade u(z) = 6 z^5 - 15 z^4 + 10 z^3. Values are computed in doubles with an
// allowance for rounding. Bounds in the complex plane follow from Taylor's series of the weights. See
// docs/notes/certified-energies.md, section "Micro-texture".
namespace tubefoot {
namespace {

/// Rounding of in_cell() in doubles and of the sum of octaves. Three interpolations between numbers of up to
/// 4, each with an error below 70 units of 2^-53, have an error below 3e-14.
constexpr double octave_rounding = 1e-13;
/// Bound of |dn/dx| in a cell. The noise is the mean of two means of corner products, with weights u(x) and
/// 1 - u(x) and u' <= 15/8. Each mean is at most 2 with a slope of at most 1, so that |dn/dx| <= 15/8 4 + 1
/// = 8.5. The margin covers points up to 0.01 outside.
constexpr double steepest = 10;

/// Bound of |u| + |1 - u| at a distance d from [0, 1], with u(z) = 6 z^5 - 15 z^4 + 10 z^3. On the interval
/// the sum is 1. The Taylor coefficients there are at most 15/8, 5/sqrt 3, 10, 15 and 6.
double weights_within(double d) { return 1 + 2 * d * (1.875 + d * (2.8868 + d * (10 + d * (15 + d * 6)))); }

/// Distance of a complex rectangle from [0, 1].
double distance_from_cell(double lo, double hi, double across) {
  return std::hypot(std::max({0.0, -lo, hi - 1}), across);
}

}  // namespace

CertifiedPerlin::CertifiedPerlin(const PerlinReflectivity& field)
    : lattice_(field.lattice()),
      wavelength_m_(field.settings().wavelength_m),
      depth_(field.settings().depth) {
  const PerlinReflectivity::Settings& settings = field.settings();
  double sum = 0, weight = 1;
  for (int i = 0; i < settings.octaves; ++i, weight *= settings.persistence) {
    weight_.push_back(weight);
    sum += weight;
  }
  while (weight_.back() == 0) weight_.pop_back();
  for (double& w : weight_) w /= sum;
}

std::vector<CertifiedTexture::Axis> CertifiedPerlin::axes() const {
  const Ball per_m = Ball(std::ldexp(1.0, int(weight_.size()) - 1)) / Ball(wavelength_m_), no;
  return {{{per_m, no, no}, no}, {{no, per_m, no}, no}, {{no, no, per_m}, no}};
}

CertifiedPerlin::Within CertifiedPerlin::within(std::int64_t finest, int halvings) {
  const std::int64_t cell = finest >> halvings;
  const double scale = std::ldexp(1.0, -halvings);
  return {cell, double(finest - (cell << halvings)) * scale, scale};
}

CertifiedPerlin::Noise CertifiedPerlin::noise(std::span<const std::int64_t> cell,
                                              const std::array<Interval, 3>& place) const {
  std::array<double, 3> middle;
  double radius = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double lo = std::clamp(place[a].lo, 0.0, 1.0), hi = std::clamp(place[a].hi, 0.0, 1.0);
    middle[a] = lo + (hi - lo) / 2;
    radius += (hi - lo) / 2 * enclosure_factor + 1e-16;
  }
  const int last = int(weight_.size()) - 1;
  double sum = 0, error = 0;
  for (int i = 0; i <= last; ++i) {
    std::array<Within, 3> own;
    std::array<double, 3> x;
    for (int a = 0; a < 3; ++a) {
      own[a] = within(cell[a], last - i);
      x[a] = own[a].offset + middle[a] * own[a].scale;
    }
    const double n = lattice_.in_cell(own[0].cell, own[1].cell, own[2].cell, x[0], x[1], x[2]);
    const double off = steepest * radius * own[0].scale + octave_rounding;
    const double lo = std::max(n - off, -largest_noise), hi = std::min(n + off, largest_noise);
    sum += weight_[i] * (lo + hi) / 2;
    error += weight_[i] * (hi - lo) / 2 * enclosure_factor;
  }
  return {sum, error + octave_rounding};
}

Ball CertifiedPerlin::factor(std::span<const std::int64_t> cell, std::span<const Ball> q) const {
  std::array<Interval, 3> place;
  for (std::size_t a = 0; a < 3; ++a) {
    const Ball x = q[a] - Ball(double(cell[a]));
    place[a] = {x.lo(), x.hi()};
  }
  const Noise found = noise(cell, place);
  Ball value(found.value);
  value.add_error(Ball(found.error));
  return Ball(1) + Ball(depth_) * value;
}

Interval CertifiedPerlin::factor(std::span<const std::int64_t> cell, std::span<const Interval> q) const {
  std::array<Interval, 3> place;
  for (std::size_t a = 0; a < 3; ++a) place[a] = q[a] - double(cell[a]);
  const Noise found = noise(cell, place);
  return 1.0 + depth_ * (found.value + Interval(-found.error, found.error));
}

double CertifiedPerlin::largest(std::span<const std::int64_t> cell, std::span<const ComplexBall> q) const {
  std::array<double, 3> lo, hi, across;
  for (int a = 0; a < 3; ++a) {
    const Ball x = q[a].real() - Ball(double(cell[a])), y = q[a].imaginary();
    lo[a] = x.lo();
    hi[a] = x.hi();
    across[a] = std::max(std::abs(y.lo()), std::abs(y.hi()));
  }
  const int last = int(weight_.size()) - 1;
  double sum = 0;
  for (int i = 0; i <= last; ++i) {
    double weights = 1, dots = 0, least = 1e300;
    for (int a = 0; a < 3; ++a) {
      const Within own = within(cell[a], last - i);
      const double d = distance_from_cell(own.offset + lo[a] * own.scale, own.offset + hi[a] * own.scale,
                                          across[a] * own.scale);
      weights *= weights_within(d);
      dots += 1 + d;
      least = std::min(least, 1 + d);
    }
    sum += weight_[i] * weights * (dots - least);  // gradients have two components of 1 or -1
  }
  return (1 + std::abs(depth_) * sum) * enclosure_factor;
}

double CertifiedPerlin::difference(double off) const { return 2 * change(off); }

double CertifiedPerlin::change(double off) const {
  return 3 * steepest * off * std::abs(depth_) * enclosure_factor;
}

Ball CertifiedPerlin::range() const {
  return Ball(1) + Ball(std::abs(depth_) * largest_noise * enclosure_factor) * Ball::between(-1, 1);
}

}  // namespace tubefoot
