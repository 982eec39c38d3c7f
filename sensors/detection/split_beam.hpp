// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <span>

namespace tubefoot {

/// Window of a beam in which the zero of the phase between its halves is searched. Positions and lengths are
/// in samples.
struct SplitBeamSearch {
  double from = 0;            ///< position of the echo by its amplitude
  double half_window = 0;     ///< number of samples on either side that may contain the main lobe's echo
  double edge_rad = 0;        ///< phase at the border of the main lobe; samples beyond it do not count
  double bend = 0;            ///< the phase is proportional to x + bend x^2, where x counts samples from the
                              ///< zero
  double samples_a_look = 1;  ///< sampling rate over bandwidth: number of samples per independent look
};

/// Curvature of the phase over a level seabed, where the sine of the angle is not linear in range. Returns
/// SplitBeamSearch::bend for a seabed at the across-track sine `sine` (0 to 1) and samples of length
/// `step_m`.
double level_seabed_bend(double range_m, double sine, double step_m);

struct SplitBeamDetection {
  double sample = 0;        ///< position of the zero of the phase
  double sigma = 0;         ///< its standard deviation, in samples
  double slope_rad = 0;     ///< slope of the phase per sample
  std::size_t samples = 0;  ///< number of samples in the fit
};

/// Finds the sample that arrives from a beam's axis. Both halves of an array are steered along the axis.
/// They receive arrivals from either side of it with phases of opposite signs. `product` is the signal of
/// one half times the conjugate of the other. Over a sloping seabed its phase passes linearly through zero.
/// The first line is the one with the largest coherent sum of the product, which phase wrapping does not
/// disturb. A least-squares fit within the main lobe, weighted by the product's modulus, then refines the
/// line. The standard deviation follows from the residuals of the line.
///
/// Returns nothing if fewer than four independent looks lie within the main lobe; at nadir the seabed fills
/// the lobe at once. Returns nothing either if the phase changes by less than half a radian, or if its zero
/// lies outside of the window.
std::optional<SplitBeamDetection> split_beam_zero(std::span<const std::complex<double>> product,
                                                  const SplitBeamSearch& search);

}  // namespace tubefoot
