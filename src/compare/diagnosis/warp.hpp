// SPDX-License-Identifier: GPL-3.0-or-later
// What an engine's mistakes of geometry make of the true picture.
#pragma once

#include <cstddef>
#include <vector>

#include "compare/measures/echo_errors.hpp"

namespace tubefoot {

/// The beams' order in the candidate.
enum class BeamOrder { as_is, mirrored, halves_swapped, halves_mirrored };

/// Where the candidate shows what the truth has. Displacements are towards larger beam and sample numbers.
struct Warp {
  BeamOrder order = BeamOrder::as_is;
  double beams = 0;          ///< shift
  double samples = 0;        ///< shift
  double azimuth_scale = 0;  ///< displacement per beam of distance from the fan's middle
  double range_scale = 0;    ///< displacement per range
  int views = 1;             ///< how many pictures side by side make the fan
  double tangent = 0;    ///< 0: beams even in angle, 1: even in the tangent of the angle from a view's middle
  double beam_blur = 0;  ///< variance of a Gaussian, beams^2
  double sample_blur = 0;  ///< the same, samples^2
};

/// Pictures of one fan: azimuths and slant ranges of their bins.
class Fan {
 public:
  Fan(const EchoShape& shape, std::vector<double> beam_azimuth_deg, std::vector<double> slant_range_m);

  const EchoShape& shape() const { return shape_; }
  const std::vector<double>& ranges_m() const { return ranges_m_; }
  double range_m(std::size_t sample) const { return ranges_m_[sample]; }
  double sample_m() const { return sample_m_; }
  double beam_deg() const { return beam_deg_; }
  /// Whether beams lie side by side, so that they can be shifted; one or two are waters apart.
  bool has_width() const { return shape_.beams > 4; }

  /// How far the candidate shows at this beam what the truth has before it, beams; likewise samples.
  double beam_displacement(const Warp& warp, std::size_t beam) const;
  double sample_displacement(const Warp& warp, std::size_t sample) const;
  /// The largest displacement that the tangent makes, beams.
  double largest_of_tangent(int views) const;

  /// What the candidate would have if the truth were this, energies as [ping][beam][sample].
  std::vector<double> warped(const std::vector<double>& energy_j, const Warp& warp) const;

  /// A copy blurred by Gaussians of these variances; slightly negative ones sharpen.
  std::vector<double> blurred(std::vector<double> energy_j, double beam_blur, double sample_blur) const;

 private:
  double tangent_displacement(int views, std::size_t beam) const;

  EchoShape shape_;
  std::vector<double> azimuths_deg_, ranges_m_;
  double sample_m_ = 1, beam_deg_ = 1, middle_deg_ = 0;
};

}  // namespace tubefoot
