// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/platform_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <stdexcept>

// Fits piecewise polynomials to a motion: Chebyshev interpolation of degree at most 7, with pieces halved
// until the error is within the tolerance.

namespace tubefoot {
namespace {

// Numbers of points at which polynomials are compared with the motion. The first levels use more points, so
// that no kink lies between them.
constexpr int checks = 9, first_checks = 33, first_depths = 3;
/// Pieces of this length may contain a kink. Times of reception across such a piece are computed per sample.
constexpr double bend_s = 1e-5;
/// A motion that is not smooth over this time has a jump.
constexpr double jump_s = 1e-12;

}  // namespace

void MotionBounds::widen(const MotionBounds& other) {
  speed_m_s = std::max(speed_m_s, other.speed_m_s);
  acceleration_m_s2 = std::max(acceleration_m_s2, other.acceleration_m_s2);
  jerk_m_s3 = std::max(jerk_m_s3, other.jerk_m_s3);
}

struct TabulatedMotion::Source {
  const PlatformMotion& motion;
  glm::dvec3 origin_m;
  double tolerance_m, limit_m_s;
  const std::string& what;

  glm::dvec3 at(double time_s) const {
    const glm::dvec3 place = motion(time_s);
    if (!std::isfinite(place.x + place.y + place.z))
      throw std::invalid_argument(
          fmt::format("the motion of {} is not finite {} s after the start of the ping: motions must be "
                      "valid from the start of the pulse to the last sample",
                      what, time_s));
    return place - origin_m;
  }
  [[noreturn]] void refuse(double time_s) const {
    throw std::invalid_argument(
        fmt::format("{} moves at {} m/s or more, as fast as sound, about {} s after the start of the ping, "
                    "so travel times are undefined: reduce its speed",
                    what, limit_m_s, time_s));
  }
};

const TabulatedMotion::Piece& TabulatedMotion::piece_at(double time_s) const {
  return *(std::upper_bound(piece_.begin() + 1, piece_.end(), time_s,
                            [](double time, const Piece& piece) { return time < piece.begin_s; }) -
           1);
}

TabulatedMotion::TabulatedMotion(glm::dvec3 place_m)
    : begin_s_(-std::numeric_limits<double>::infinity()), end_s_(-begin_s_), piece_(1) {
  piece_.front().power[0] = place_m;
}

TabulatedMotion::TabulatedMotion(const PlatformMotion& motion, double begin_s, double end_s,
                                 glm::dvec3 origin_m, double tolerance_m, double limit_m_s,
                                 const std::string& what)
    : begin_s_(begin_s), end_s_(end_s) {
  fit({motion, origin_m, tolerance_m, limit_m_s, what}, begin_s, end_s, 0);
}

void TabulatedMotion::fit(const Source& source, double begin_s, double end_s, int depth) {
  const double half_s = (end_s - begin_s) / 2;
  Piece piece{begin_s, (begin_s + end_s) / 2, 1 / half_s, 0, {}};
  constexpr int nodes = degree + 1;
  std::array<glm::dvec3, nodes> value;
  for (int a = 0; a < nodes; ++a)
    value[std::size_t(a)] =
        source.at(piece.middle_s + half_s * std::cos(std::numbers::pi * (a + 0.5) / nodes));
  std::array<glm::dvec3, first_checks> check;
  const int count = depth < first_depths ? first_checks : checks;
  const auto share_of = [&](int n) { return 2.0 * n / (count - 1) - 1; };
  double farthest = 0;
  for (int n = 0; n < count; ++n) {
    check[std::size_t(n)] = source.at(piece.middle_s + half_s * share_of(n));
    farthest = std::max(farthest, glm::length(check[std::size_t(n)] + source.origin_m));
  }
  // Chebyshev series from the nodes, converted to powers of the lowest sufficient degree.
  std::array<glm::dvec3, nodes> series{};
  for (int k = 0; k < nodes; ++k)
    for (int a = 0; a < nodes; ++a)
      series[std::size_t(k)] += (k == 0 ? 1.0 : 2.0) / nodes *
                                std::cos(std::numbers::pi * k * (a + 0.5) / nodes) * value[std::size_t(a)];
  const double rounding = 16 * std::numeric_limits<double>::epsilon() * farthest;
  const bool rests =
      std::all_of(value.begin(), value.end(), [&](glm::dvec3 v) { return v == check[0]; }) &&
      std::all_of(check.begin(), check.begin() + count, [&](glm::dvec3 v) { return v == check[0]; });
  if (rests) {
    piece.power[0] = check[0];
    take(piece);
    return;
  }
  for (const int degrees : {1, 3, degree}) {
    piece.degree = degrees;
    piece.power = {};
    std::array<double, nodes> before{}, now{1};  // T_(k-1), T_k
    for (int k = 0; k <= degrees; ++k) {
      for (int n = 0; n <= k; ++n)
        piece.power[std::size_t(n)] += now[std::size_t(n)] * series[std::size_t(k)];
      std::array<double, nodes> next{};
      for (int n = 0; n + 1 < nodes; ++n) next[std::size_t(n + 1)] = (k == 0 ? 1 : 2) * now[std::size_t(n)];
      for (int n = 0; k > 0 && n < nodes; ++n) next[std::size_t(n)] -= before[std::size_t(n)];
      before = now;
      now = next;
    }
    double worst = 0;
    for (int n = 0; n < count; ++n)
      worst = std::max(worst, glm::distance(piece.at(share_of(n)).place_m, check[std::size_t(n)]));
    if (worst > source.tolerance_m + rounding) continue;
    take(piece);
    if (bounds_.speed_m_s >= source.limit_m_s) source.refuse(piece.middle_s);
    return;
  }
  if (half_s < jump_s * (1 + std::abs(piece.middle_s))) source.refuse(piece.middle_s);
  fit(source, begin_s, piece.middle_s, depth + 1);
  fit(source, piece.middle_s, end_s, depth + 1);
}

void TabulatedMotion::take(const Piece& piece) {
  piece_.push_back(piece);
  const double half = 1 / piece.per_s;
  double acceleration = 0, jerk = 0;
  for (int k = 2; k <= piece.degree; ++k) {
    const double size = k * (k - 1) * glm::length(piece.power[std::size_t(k)]) / (half * half);
    acceleration += size;
    jerk += (k - 2) * size / half;
  }
  // Between neighbouring points the speed changes by at most what the acceleration permits.
  double speed = 0;
  for (int n = 0; n < checks; ++n)
    speed = std::max(speed, glm::length(piece.at(2.0 * n / (checks - 1) - 1).velocity_m_s));
  bounds_.widen({speed + acceleration * half / (checks - 1), 0, 0});
  if (2 * half >= bend_s) bounds_.widen({0, acceleration, jerk});
}

}  // namespace tubefoot
