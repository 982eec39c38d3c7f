// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace tubefoot {

/// Position of a channel's end as a function of time after the start of the ping, in m in the local frame.
/// Null: the end is at rest.
using PlatformMotion = std::function<glm::dvec3(double after_start_s)>;

/// Upper bounds of the motion of an end.
struct MotionBounds {
  double speed_m_s = 0, acceleration_m_s2 = 0, jerk_m_s3 = 0;

  void widen(const MotionBounds& other);
  bool operator==(const MotionBounds& other) const = default;
};

/// Motion as piecewise polynomials, which are fast to evaluate and to differentiate. At a kink of the motion
/// (a track from pose to pose) the pieces are as short as the tolerance requires.
class TabulatedMotion {
 public:
  /// At rest at all times.
  explicit TabulatedMotion(glm::dvec3 place_m);
  /// `motion` from begin to end relative to `origin_m`, and linear beyond. `what`: name in messages. Throws
  /// std::invalid_argument for positions that are not finite, and for speeds of `limit_m_s` or more.
  TabulatedMotion(const PlatformMotion& motion, double begin_s, double end_s, glm::dvec3 origin_m,
                  double tolerance_m, double limit_m_s, const std::string& what);

  struct Moment {
    glm::dvec3 place_m, velocity_m_s;
  };
  Moment at(double time_s) const {
    const Piece& piece = piece_.size() == 1 ? piece_.front() : piece_at(time_s);
    return piece.at((time_s - piece.middle_s) * piece.per_s);
  }
  /// Whether one polynomial covers both times.
  bool is_smooth(double from_s, double to_s) const {
    return from_s >= begin_s_ && to_s <= end_s_ &&
           (piece_.size() == 1 || &piece_at(from_s) == &piece_at(to_s));
  }
  bool moves() const { return bounds_.speed_m_s > 0; }
  const MotionBounds& bounds() const { return bounds_; }

  bool operator==(const TabulatedMotion& other) const = default;

 private:
  static constexpr int degree = 7;
  struct Piece {
    double begin_s = 0, middle_s = 0, per_s = 1;
    int degree = 0;
    std::array<glm::dvec3, TabulatedMotion::degree + 1> power{};  ///< coefficients of the powers of (time -
                                                                  ///< middle) * per_s
    /// `share`: from -1 to 1.
    Moment at(double share) const {
      const double within = std::clamp(share, -1.0, 1.0);
      glm::dvec3 place = power[std::size_t(degree)], slope(0);
      for (int k = degree - 1; k >= 0; --k) {
        slope = slope * within + place;
        place = place * within + power[std::size_t(k)];
      }
      return {place + (share - within) * slope, slope * per_s};
    }
    bool operator==(const Piece& other) const = default;
  };
  struct Source;
  const Piece& piece_at(double time_s) const;
  void fit(const Source& source, double begin_s, double end_s, int depth);
  void take(const Piece& piece);

  double begin_s_, end_s_;
  std::vector<Piece> piece_;
  MotionBounds bounds_;
};

}  // namespace tubefoot
