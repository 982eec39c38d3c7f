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

/// Where an end of a channel is some time after the ping's start [m, local frame]. None: it is at rest.
using PlatformMotion = std::function<glm::dvec3(double after_start_s)>;

/// What an end's motion stays below.
struct MotionBounds {
  double speed_m_s = 0, acceleration_m_s2 = 0, jerk_m_s3 = 0;

  void widen(const MotionBounds& other);
  bool operator==(const MotionBounds& other) const = default;
};

/// A way as polynomials, piece by piece, which are cheap to follow and whose derivatives are at hand. Where a
/// way bends (a track from pose to pose), pieces become as short as the tolerance asks for.
class TabulatedMotion {
 public:
  /// At rest, for all times.
  explicit TabulatedMotion(glm::dvec3 place_m);
  /// `motion` from begin to end, less `origin_m`; beyond it goes straight on. `what` names it in messages.
  /// Throws std::invalid_argument for places that are not finite, and for speeds that reach `limit_m_s`.
  TabulatedMotion(const PlatformMotion& motion, double begin_s, double end_s, glm::dvec3 origin_m,
                  double tolerance_m, double limit_m_s, const std::string& what);

  struct Moment {
    glm::dvec3 place_m, velocity_m_s;
  };
  Moment at(double time_s) const {
    const Piece& piece = piece_.size() == 1 ? piece_.front() : piece_at(time_s);
    return piece.at((time_s - piece.middle_s) * piece.per_s);
  }
  /// One polynomial holds between both times.
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
    std::array<glm::dvec3, TabulatedMotion::degree + 1> power{};  ///< of (time - middle) * per_s
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
