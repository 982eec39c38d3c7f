// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <optional>
#include <vector>

namespace tubefoot {

/// What two receivers, one above the other, make of the paths in one range sample: their energies and the
/// mean product of the upper signal with the lower one's conjugate.
struct InterferometricSample {
  double upper_j = 0, lower_j = 0;
  std::complex<double> cross_j = 0;

  /// A path, equally strong at both. `path_difference_m`: how much longer the way to the upper receiver is.
  void add(double energy_j, double path_difference_m, double wavelength_m);
  /// Receiver noise, which the two do not share: the coherence falls.
  void add_noise(double upper_noise_j, double lower_noise_j);

  /// Phase difference in (-pi, pi]; none if there is no common signal.
  std::optional<double> phase_rad() const;
  /// |cross| / sqrt(upper lower), 0 to 1; 0 without energy.
  double coherence() const;
};

/// A phase brought into (-pi, pi].
double wrapped(double phase_rad);

/// A bottom point found at a slant range.
struct DepthEstimate {
  double angle_rad = 0;                           ///< below the horizontal
  double horizontal_m = 0;                        ///< distance from the receivers
  double depth_m = 0;                             ///< below the receivers
  double angle_sigma_rad = 0, depth_sigma_m = 0;  ///< standard deviations, to first order
};

/// Two receivers on a receiver pair, for waves that are plane along it: a point at slant range R seems
/// (baseline / R)^2 / 16 rad away from its place at most. An angle of arrival is measured from the horizontal
/// downwards, and so is the tilt, of the direction that the receiver pair faces. What arrives from behind the
/// receiver pair is not resolved from its mirror image in front.
///
/// phase = (2 pi baseline / wavelength) sin(angle - tilt), known up to whole turns. Up to half a wavelength
/// of baseline there is one angle for a phase; a longer baseline has about 2 baseline / wavelength of them,
/// and what is known of the bottom (a flat one, or the sample before) has to choose.
class Interferometer {
 public:
  /// Throws std::invalid_argument unless 0 < wavelength, 0 < baseline <= 10^4 wavelengths and tilt are
  /// finite.
  Interferometer(double baseline_m, double wavelength_m, double tilt_rad);

  /// Phase difference of a wave, wrapped.
  double phase(double angle_rad) const { return wrapped(turn_ * sine(angle_rad)); }
  /// All angles within a right angle of the tilt that have the wrapped phase, ascending. May be none.
  std::vector<double> angles(double phase_rad) const;
  /// Of the angles that a phase stands for, the one whose unwrapped phase is nearest to that of
  /// `expected_rad`: within half a turn, but where no angle in front of the receiver pair is, which noise can
  /// bring about near its ends. A phase that no wave has (noise on a baseline below half a wavelength) stands
  /// for the end of the receiver pair whose phase is nearest.
  double angle_near(double phase_rad, double expected_rad) const;
  /// Standard deviation wavelength sigma / (2 pi baseline cos(angle - tilt)), no more than that of an angle
  /// of which nothing is known, pi / sqrt 12.
  double angle_sigma(double angle_rad, double phase_sigma_rad) const;
  /// The point at a slant range and angle: depth R sin(angle), distance R cos(angle).
  DepthEstimate point(double range_m, double angle_rad, double phase_sigma_rad) const;

 private:
  double sine(double angle_rad) const;

  double turn_;  ///< 2 pi baseline / wavelength: phase of a wave along the receiver pair
  double tilt_rad_;
};

}  // namespace tubefoot
