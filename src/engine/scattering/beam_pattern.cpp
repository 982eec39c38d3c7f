// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/beam_pattern.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "engine/scattering/pair_density.hpp"
#include "geometry/numbers/scalars.hpp"

// Evaluates beam patterns: sinc^2 for line arrays, (2 J1(x) / x)^2 for pistons, Gaussian patterns, and tables
// with monotone cubic interpolation. Also bounds their growth in the complex plane, for error bounds of
// quadratures.

namespace tubefoot {
namespace {

double squared(double x) { return x * x; }

double sinc(double x) {
  const double y = pi * x;
  // For smaller values the square differs from 1 by less than a rounding error.
  return std::abs(y) < 1e-8 ? 1.0 : std::sin(y) / y;
}

double piston(double x) {
  // J1(x) / (x/2) = 1 - x^2/8 + x^4/192 - ...
  if (std::abs(x) < 1e-2) return squared(1 - x * x / 8 * (1 - x * x / 24));
  return squared(2 * boost::math::cyl_bessel_j(1, x) / x);
}

/// Returns log(sinh(x) / x) for x >= 0, rounded up by less than 1e-3 of it.
double log_sinhc(double x) {
  if (x < 0.1) return x * x / 6;
  return x < 20 ? std::log(std::sinh(x) / x) : x - std::log(2 * x);
}

/// Returns the slopes of Fritsch & Carlson's monotone cubic, by their weighted harmonic mean (Fritsch &
/// Butland 1984). They are 0 at both ends, beyond which the level is constant.
std::vector<double> slopes_of(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> slope(x.size(), 0);
  for (std::size_t k = 1; k + 1 < x.size(); ++k) {
    const double h0 = x[k] - x[k - 1], h1 = x[k + 1] - x[k];
    const double d0 = (y[k] - y[k - 1]) / h0, d1 = (y[k + 1] - y[k]) / h1;
    if (d0 * d1 <= 0) continue;
    const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
    slope[k] = (w0 + w1) / (w0 / d0 + w1 / d1);
  }
  return slope;
}

}  // namespace

PatternTable::PatternTable(std::vector<double> angle_rad, const std::vector<double>& level_db)
    : angle_(std::move(angle_rad)) {
  if (angle_.size() < 2 || angle_.size() != level_db.size())
    throw std::invalid_argument("a beam pattern needs at least two angles and a level for each angle");
  for (std::size_t k = 0; k < angle_.size(); ++k)
    if (!std::isfinite(angle_[k]) || !std::isfinite(level_db[k]) || (k > 0 && !(angle_[k] > angle_[k - 1])))
      throw std::invalid_argument(
          fmt::format("a beam pattern needs finite levels at increasing angles; entry {} is invalid", k));
  const std::vector<double> slope = slopes_of(angle_, level_db);
  segments_.push_back({angle_.front(), {level_db.front(), 0, 0, 0}});
  for (std::size_t k = 0; k + 1 < angle_.size(); ++k) {
    const double h = angle_[k + 1] - angle_[k], d = (level_db[k + 1] - level_db[k]) / h;
    const double c2 = (3 * d - 2 * slope[k] - slope[k + 1]) / h;
    const double c3 = (slope[k] + slope[k + 1] - 2 * d) / (h * h);
    segments_.push_back({angle_[k], {level_db[k], slope[k], c2, c3}});
    // A monotone cubic is never steeper than three times its chord.
    steepest_ = std::max(steepest_, 3 * std::abs(d));
  }
  segments_.push_back({angle_.back(), {level_db.back(), 0, 0, 0}});
}

std::size_t PatternTable::segment_at(double angle_rad) const {
  return std::size_t(std::upper_bound(angle_.begin(), angle_.end(), angle_rad) - angle_.begin());
}

double PatternTable::level_db(double angle_rad) const {
  const Segment& s = segments_[segment_at(angle_rad)];
  const double x = angle_rad - s.from;
  return s.c[0] + x * (s.c[1] + x * (s.c[2] + x * s.c[3]));
}

double line_amplitude(double u, double shading) {
  return shading == 0 ? sinc(u) : sinc(u) + shading / 2 * (sinc(u - 1) + sinc(u + 1));
}

double Directivity::gain_at(double cosine) const {
  const double w = std::clamp(cosine, -1.0, 1.0);
  switch (kind) {
    case Kind::uniform:
      return 1;
    case Kind::line:
      return squared(line_amplitude(size * (w - centre), shading));
    case Kind::piston:
      return piston(size * std::sqrt(1 - w * w));
    case Kind::gaussian:
    case Kind::table:
      break;
  }
  const double angle = from_axis ? std::acos(w) : std::asin(w) - std::asin(centre);
  if (kind == Kind::gaussian) return std::exp(-4 * std::numbers::ln2 * squared(angle / size));
  return std::pow(10, table->level_db(angle) / 10);
}

double TransmitPattern::gain(glm::dvec3 direction) const {
  double sum = 0;
  for (const Directivity& beam : beams) sum += beam.gain(direction);
  return sum;
}

double ReceiverBaseline::path_difference(double range_m, double cosine) const {
  const double level = range_m * range_m + baseline_m * baseline_m / 4, tilt = range_m * baseline_m * cosine;
  return range_difference(tilt,
                          std::sqrt(std::max(level - tilt, 0.0)) + std::sqrt(std::max(level + tilt, 0.0)));
}

double ReceiverBaseline::range_from(double end, double range_m, double cosine) const {
  return std::sqrt(
      std::max(range_m * range_m + baseline_m * baseline_m / 4 - end * range_m * baseline_m * cosine, 0.0));
}

double Directivity::growth(double y) const {
  switch (kind) {
    case Kind::uniform:
      return 0;
    case Kind::line:  // weights near the centre grow less than uniform weights
      return 2 * log_sinhc(pi * size * y);
    case Kind::piston:
      return 2 * size * y;
    case Kind::gaussian:
      return 4 * std::numbers::ln2 * squared(y / size);
    case Kind::table:
      return std::numbers::ln10 / 10 * table->steepest() * y;
  }
  return 0;
}

}  // namespace tubefoot
