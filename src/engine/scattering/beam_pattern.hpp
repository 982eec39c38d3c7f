// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <utility>
#include <vector>

namespace tubefoot {

/// A measured pattern: level in dB over an angle, interpolated by the monotone cubic of Fritsch & Carlson
/// (1980), which neither overshoots nor leaves the table's values between two of its angles, and held at its
/// first and last level outside of them.
class PatternTable {
 public:
  /// A cubic in (angle - from): level_db = c[0] + c[1] x + c[2] x^2 + c[3] x^3.
  struct Segment {
    double from = 0, c[4] = {};
  };
  /// Angles in radians, increasing, at least two; finite levels. Throws std::invalid_argument.
  PatternTable(std::vector<double> angle_rad, const std::vector<double>& level_db);

  double level_db(double angle_rad) const;
  /// Segment k holds angles below border(k) and not below border(k - 1); the first and the last are constant.
  const std::vector<Segment>& segments() const { return segments_; }
  std::size_t segment_at(double angle_rad) const;
  const std::vector<double>& borders() const { return angle_; }
  /// Largest |d level / d angle|, dB per radian.
  double steepest() const { return steepest_; }

 private:
  std::vector<double> angle_;
  std::vector<Segment> segments_;
  double steepest_ = 0;
};

/// A power pattern, 1 on its axis, that depends on a direction through one cosine: that between the direction
/// and `axis`. For a line array the axis is the array; a pattern about the beam's axis has that for its own.
struct Directivity {
  enum class Kind {
    uniform,   ///< 1 everywhere
    line,      ///< sinc^2(size * (cosine - centre)), size = length / wavelength, sinc x = sin(pi x) / (pi x)
    piston,    ///< (2 J1(x) / x)^2, x = size * sine, size = pi diameter / wavelength; alike in front and
               ///< behind
    gaussian,  ///< exp(-4 ln 2 (angle / size)^2), size = full width at -3 dB, radians
    table      ///< PatternTable over the angle
  };
  Kind kind = Kind::uniform;
  glm::dvec3 axis{0, 1, 0};  ///< unit
  /// gaussian and table: the angle is that from the axis; else asin(cosine) - asin(centre), an angle from the
  /// plane that is perpendicular to the axis.
  bool from_axis = false;
  double centre = 0;  ///< cosine of the beam's own direction; not used with from_axis
  double size = 0;
  std::shared_ptr<const PatternTable> table{};

  /// Power in a direction (unit vector) relative to that on the beam's axis.
  double gain(glm::dvec3 direction) const { return gain_at(glm::dot(direction, axis)); }
  double gain_at(double cosine) const;

  /// How fast the pattern may grow along a path in the complex plane of directions: over a segment of
  /// directions half_extent long to either side, |gain| <= exp(growth(y)) in the ellipse that reaches y into
  /// the imaginary.
  double growth(double imaginary_extent) const;
};

/// What a transmission sends in a direction: the sum of the powers of beams that are sent at once. One
/// uniform beam by default.
struct TransmitPattern {
  std::vector<Directivity> beams{Directivity()};

  TransmitPattern() = default;
  TransmitPattern(Directivity beam) : beams{std::move(beam)} {}  // NOLINT: a beam is the sum of itself
  explicit TransmitPattern(std::vector<Directivity> simultaneous) : beams(std::move(simultaneous)) {}

  /// Power in a direction (unit vector) relative to that of one beam on its axis; may exceed 1.
  double gain(glm::dvec3 direction) const;
};

/// Two receivers of a fan on a receiver pair, at half the baseline to either side of the transmitter. What
/// they make of a point depends on its range from the transmitter and on one cosine only.
struct ReceiverBaseline {
  glm::dvec3 axis{0, 0, 1};  ///< unit, along the receiver pair, from the lower to the upper receiver
  double baseline_m = 0;
  double wavenumber_rad_m = 0;  ///< 2 pi / wavelength

  /// How much longer the way from the transmitter over a point to the upper receiver is than that to the
  /// lower one. `cosine`: between the point's direction and the axis. Exact, near or far.
  double path_difference(double range_m, double cosine) const;
  /// Range from the upper (`end` 1) or the lower (-1) receiver.
  double range_from(double end, double range_m, double cosine) const;
  /// exp(i wavenumber path_difference): upper signal times the conjugate of the lower one.
  std::complex<double> product(double range_m, double cosine) const {
    return std::polar(1.0, wavenumber_rad_m * path_difference(range_m, cosine));
  }
};

/// The patterns of a sonar at one pose, in the local frame. Beams belong to fans (one transmission and one
/// receiver each): a beam with a receive pattern receives all tubes of its fan, one without only its own.
struct BeamPatterns {
  std::vector<TransmitPattern> transmit;   ///< by fan
  std::vector<Directivity> receive;        ///< by beam
  std::vector<std::uint32_t> fan_of_tube;  ///< by tube
  /// By tube: the beams [first, second) that receive it.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> beams_of_tube;
  /// By fan, or none. With baselines an echo has four channels: energies of the upper and of the lower
  /// receiver, each by its own range, and the real and the imaginary part of energies times Fringe::product
  /// where both are in the same sample.
  std::vector<ReceiverBaseline> baselines{};
  /// By beam, or none: a beam receives nothing from directions whose two-way gain is less
  /// (pattern_levels.hpp). Energies are then integrated over a border that quadratures do not know: they are
  /// never more than without it, and as exact as their nodes are dense. Of several scatterings the receive
  /// gain alone counts, with its own limit (PathSettings::least_received).
  std::vector<double> least{};

  bool receives(std::size_t beam, double two_way_gain) const {
    return least.empty() || two_way_gain >= least[beam];
  }
  int channels() const { return baselines.empty() ? 1 : 4; }
};

}  // namespace tubefoot
