// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <utility>
#include <vector>

// Beam patterns of transmitters and receivers: line arrays, pistons, Gaussian and measured patterns, each a
// function of one cosine. Also the geometry of a receiver pair, whose phase difference is wavenumber times
// path difference.

namespace tubefoot {

/// A measured pattern: level in dB as a function of an angle. It is interpolated by the monotone cubic of
/// Fritsch & Carlson (1980), which does not overshoot and stays between the values of neighbouring angles.
/// Outside of the table the first and the last level are used.
class PatternTable {
 public:
  /// A cubic in x = angle - from: level_db = c[0] + c[1] x + c[2] x^2 + c[3] x^3.
  struct Segment {
    double from = 0, c[4] = {};
  };
  /// Angles in radians, increasing, at least two; finite levels. Throws std::invalid_argument.
  PatternTable(std::vector<double> angle_rad, const std::vector<double>& level_db);

  double level_db(double angle_rad) const;
  /// Segment k applies to angles below border(k) and not below border(k - 1); the first and the last segments
  /// are constant.
  const std::vector<Segment>& segments() const { return segments_; }
  std::size_t segment_at(double angle_rad) const;
  const std::vector<double>& borders() const { return angle_; }
  /// Returns the largest |d level / d angle|, in dB per radian.
  double steepest() const { return steepest_; }

 private:
  std::vector<double> angle_;
  std::vector<Segment> segments_;
  double steepest_ = 0;
};

/// Amplitude pattern of a line array of unit length: sinc u + shading / 2 (sinc(u - 1) + sinc(u + 1)).
/// The function sinc u is sin(pi u) / (pi u). The elements have the weight 1 + shading cos(2 pi x) at the
/// distance x from the centre. `shading`: 0 for uniform weights, 0.852 for the Hamming window, 1 for the Hann
/// window. The modulus is at most 1, because weights are not negative and have the mean 1. Source: Harris
/// 1978, section V.C.
double line_amplitude(double u, double shading);

/// A power pattern, 1 on its axis, that depends on a direction through one cosine: that between the direction
/// and `axis`. For a line array `axis` is the direction of the array. For a pattern about the beam's axis it
/// is the beam's axis.
struct Directivity {
  enum class Kind {
    uniform,  ///< 1 everywhere
    line,     ///< line_amplitude(size * (cosine - centre), shading)^2, size = length / wavelength
    piston,  ///< (2 J1(x) / x)^2, x = size * sine, size = pi diameter / wavelength; equal in front and behind
    gaussian,  ///< exp(-4 ln 2 (angle / size)^2), size = full width at -3 dB, radians
    table      ///< PatternTable over the angle
  };
  Kind kind = Kind::uniform;
  glm::dvec3 axis{0, 1, 0};  ///< unit vector
  /// Meaning of the angle for gaussian and table. With from_axis it is the angle from the axis. Otherwise it
  /// is asin(cosine) - asin(centre), an angle from the plane perpendicular to the axis.
  bool from_axis = false;
  double centre = 0;  ///< cosine of the beam's own direction; not used with from_axis
  double size = 0;
  double shading = 0;  ///< of a line array: line_amplitude()
  std::shared_ptr<const PatternTable> table{};

  /// Returns the power in a direction (unit vector) relative to that on the beam's axis.
  double gain(glm::dvec3 direction) const { return gain_at(glm::dot(direction, axis)); }
  double gain_at(double cosine) const;

  /// Returns a bound on the growth of the pattern along a path in the complex plane of directions. For a
  /// segment of directions of length half_extent to either side, |gain| <= exp(growth(y)) in the ellipse with
  /// the imaginary half-axis y.
  double growth(double imaginary_extent) const;
};

/// The power that a transmission emits in a direction: the sum over simultaneous beams. One uniform beam by
/// default.
struct TransmitPattern {
  std::vector<Directivity> beams{Directivity()};

  TransmitPattern() = default;
  TransmitPattern(Directivity beam) : beams{std::move(beam)} {}  // NOLINT: a beam is the sum of itself
  explicit TransmitPattern(std::vector<Directivity> simultaneous) : beams(std::move(simultaneous)) {}

  /// Returns the power in a direction (unit vector) relative to that of one beam on its axis. It may exceed
  /// 1.
  double gain(glm::dvec3 direction) const;
};

/// A receiver pair of a fan, at half the baseline to either side of the transmitter. Its signals from a point
/// depend only on the point's range from the transmitter and on one cosine.
struct ReceiverBaseline {
  glm::dvec3 axis{0, 0, 1};  ///< unit vector from the lower to the upper receiver
  double baseline_m = 0;
  double wavenumber_rad_m = 0;  ///< 2 pi / wavelength

  /// Returns the difference of the paths from the transmitter over a point: path to the upper receiver minus
  /// path to the lower one. `cosine` is that between the point's direction and the axis. Exact, in the near
  /// and the far field.
  double path_difference(double range_m, double cosine) const;
  /// Returns the range from the upper (`end` 1) or the lower (-1) receiver.
  double range_from(double end, double range_m, double cosine) const;
  /// Returns exp(i wavenumber path_difference): the upper signal times the conjugate of the lower one.
  std::complex<double> product(double range_m, double cosine) const {
    return std::polar(1.0, wavenumber_rad_m * path_difference(range_m, cosine));
  }
};

/// The patterns of a sonar at one pose, in the local frame. Beams belong to fans (one transmission and one
/// receiver each). A beam with a receive pattern receives all tubes of its fan; a beam without one receives
/// only its own tubes.
struct BeamPatterns {
  std::vector<TransmitPattern> transmit;   ///< per fan
  std::vector<Directivity> receive;        ///< per beam
  std::vector<std::uint32_t> fan_of_tube;  ///< per tube
  /// Per tube: the beams [first, second) that receive it.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> beams_of_tube;
  /// Per fan, or empty. With baselines an echo has four channels. Two are the energies of the upper and of
  /// the lower receiver, each by its own range. The others are the real and the imaginary part of energies
  /// times ReceiverBaseline::product, for points in the same sample of both receivers.
  std::vector<ReceiverBaseline> baselines{};
  /// Per beam, or empty: the smallest two-way gain at which the beam receives energy (pattern_levels.hpp).
  /// The quadratures do not resolve the border of the region that it defines. Energies never exceed those
  /// without this limit, and their accuracy is that of the density of nodes. For multiple scattering only the
  /// receive gain counts, with its own limit (PathSettings::least_received).
  std::vector<double> least{};

  bool receives(std::size_t beam, double two_way_gain) const {
    return least.empty() || two_way_gain >= least[beam];
  }
  int channels() const { return baselines.empty() ? 1 : 4; }
};

}  // namespace tubefoot
