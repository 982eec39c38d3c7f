// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <optional>
#include <vector>

namespace tubefoot {

/// Second-order moments of the paths in one range sample at two receivers, one above the other. They are
/// both energies, and the mean product of the upper signal with the lower one's conjugate.
struct InterferometricSample {
  double upper_j = 0, lower_j = 0;
  std::complex<double> cross_j = 0;

  /// Adds a path of equal strength at both receivers. `path_difference_m` is the path to the upper receiver
  /// minus the path to the lower one.
  void add(double energy_j, double path_difference_m, double wavelength_m);
  /// Adds receiver noise, which is independent between the receivers and lowers the coherence.
  void add_noise(double upper_noise_j, double lower_noise_j);

  /// Phase difference in (-pi, pi]; empty without a common signal.
  std::optional<double> phase_rad() const;
  /// |cross| / sqrt(upper lower), 0 to 1; 0 without energy.
  double coherence() const;
};

/// The phase modulo 2 pi, in (-pi, pi].
double wrapped(double phase_rad);

/// Estimate of a bottom point at a slant range.
struct DepthEstimate {
  double angle_rad = 0;                           ///< below the horizontal
  double horizontal_m = 0;                        ///< distance from the receivers
  double depth_m = 0;                             ///< below the receivers
  double angle_sigma_rad = 0, depth_sigma_m = 0;  ///< standard deviations, to first order
};

/// A receiver pair for waves that are plane along it. At slant range R this approximation displaces a point
/// by at most (baseline / R)^2 / 16 rad. Angles of arrival count from the horizontal downwards, and so does
/// the tilt of the direction that the receiver pair faces. The pair does not distinguish an arrival from
/// behind from its mirror image in front.
///
/// The phase is
///   phase = (2 pi baseline / wavelength) sin(angle - tilt),
/// known up to whole turns. Up to a baseline of half a wavelength a phase has one angle. A longer baseline
/// has about 2 baseline / wavelength angles. Prior knowledge of the bottom (a flat one, or the sample
/// before) has to select one of them.
class Interferometer {
 public:
  /// Throws std::invalid_argument unless 0 < wavelength, 0 < baseline <= 10^4 wavelengths and tilt are
  /// finite.
  Interferometer(double baseline_m, double wavelength_m, double tilt_rad);

  /// Wrapped phase difference of a wave.
  double phase(double angle_rad) const { return wrapped(turn_ * sine(angle_rad)); }
  /// All angles within a right angle of the tilt that have the wrapped phase, in ascending order. May be
  /// empty.
  std::vector<double> angles(double phase_rad) const;
  /// The angle with this wrapped phase whose unwrapped phase is nearest to that of `expected_rad`. The
  /// difference is within half a turn, unless no angle in front of the receiver pair has that phase. Noise
  /// can cause this case near the ends of the receiver pair. A phase that no wave has (noise on a baseline
  /// below half a wavelength) gives the end of the receiver pair whose phase is nearest.
  double angle_near(double phase_rad, double expected_rad) const;
  /// Standard deviation wavelength sigma / (2 pi baseline cos(angle - tilt)). It is at most that of an
  /// unknown angle, pi / sqrt 12.
  double angle_sigma(double angle_rad, double phase_sigma_rad) const;
  /// The point at a slant range and angle: depth R sin(angle), distance R cos(angle).
  DepthEstimate point(double range_m, double angle_rad, double phase_sigma_rad) const;

 private:
  double sine(double angle_rad) const;

  double turn_;  ///< 2 pi baseline / wavelength: phase of a wave along the receiver pair
  double tilt_rad_;
};

}  // namespace tubefoot
