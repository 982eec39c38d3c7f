// SPDX-License-Identifier: GPL-3.0-or-later
// Transformation of a reference picture by the geometric errors of an engine.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "compare/measures/echo_errors.hpp"

namespace tubefoot {

/// Order of the beams in the candidate.
enum class BeamOrder { as_is, mirrored, halves_swapped, halves_mirrored };

/// Positions in the candidate of the echoes of the reference. Positive displacements are towards larger
/// beam and sample numbers.
struct Warp {
  BeamOrder order = BeamOrder::as_is;
  double beams = 0;          ///< displacement of all beams
  double samples = 0;        ///< displacement of all samples
  double azimuth_scale = 0;  ///< displacement per beam of distance from the centre of the fan
  double range_scale = 0;    ///< displacement per range
  int views = 1;             ///< number of pictures side by side that make up the fan
  double tangent = 0;    ///< 0: equiangular beams; 1: beams equidistant in the tangent of the angle from the
                         ///< centre of a view
  double beam_blur = 0;  ///< variance of a Gaussian, in beams^2
  double sample_blur = 0;  ///< variance of a Gaussian, in samples^2
  /// Additional variances at the last sample, which grow with the square of the range.
  double beam_growth = 0, sample_growth = 0;
};

/// Geometry of the pictures of a fan: azimuths and slant ranges of their bins.
class Fan {
 public:
  Fan(const EchoShape& shape, std::vector<double> beam_azimuth_deg, std::vector<double> slant_range_m);

  const EchoShape& shape() const { return shape_; }
  const std::vector<double>& ranges_m() const { return ranges_m_; }
  double range_m(std::size_t sample) const { return ranges_m_[sample]; }
  double sample_m() const { return sample_m_; }
  double beam_deg() const { return beam_deg_; }
  /// Number of views of at most 20 degrees side by side, as renderers use them.
  int usual_views() const {
    return static_cast<int>(std::ceil(std::abs(beam_deg_) * static_cast<double>(shape_.beams) / 20 - 1e-6));
  }
  /// Returns whether the beams are adjacent, so that shifts make sense. One or two beams are separate.
  bool has_width() const { return shape_.beams > 4; }

  /// Displacement in the candidate of the echo of this beam, in beams; sample_displacement() likewise in
  /// samples.
  double beam_displacement(const Warp& warp, std::size_t beam) const;
  double sample_displacement(const Warp& warp, std::size_t sample) const;
  /// Largest displacement that the tangent causes, in beams.
  double largest_of_tangent(int views) const;

  /// Bin of the reference whose echo a warp shows in this bin of the candidate, to the nearest bin; nothing
  /// outside of the picture.
  std::optional<std::size_t> source_of(const Warp& warp, std::size_t bin) const;

  /// Applies a warp to energies of the reference, [ping][beam][sample].
  std::vector<double> warped(const std::vector<double>& energy_j, const Warp& warp) const;

  /// Returns a copy blurred by Gaussians of these variances. Small negative variances sharpen.
  std::vector<double> blurred(std::vector<double> energy_j, double beam_blur, double sample_blur,
                              double beam_growth = 0, double sample_growth = 0) const;

 private:
  double tangent_displacement(int views, std::size_t beam) const;
  std::vector<double> variances(double blur, double growth) const;

  EchoShape shape_;
  std::vector<double> azimuths_deg_, ranges_m_;
  double sample_m_ = 1, beam_deg_ = 1, middle_deg_ = 0;
};

}  // namespace tubefoot
