// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <span>

namespace tubefoot {

/// Where in a beam its two halves look for the phase's zero. Places and lengths are in samples.
struct SplitBeamSearch {
  double from = 0;            ///< where the echo is by its amplitude
  double half_window = 0;     ///< samples on either side that may hold the main lobe's echo
  double edge_rad = 0;        ///< phase at the border of the main lobe: beyond it nothing counts
  double bend = 0;            ///< the phase goes as x + bend x^2, x the samples from its zero
  double samples_a_look = 1;  ///< sampling rate over bandwidth: how many samples are one independent look
};

/// Of a level seabed the line is a bow: sines of angles do not grow evenly with range.
/// SplitBeamSearch::bend of one that is met at a sine across (0 to 1), by samples of that length.
double level_seabed_bend(double range_m, double sine, double step_m);

struct SplitBeamDetection {
  double sample = 0;        ///< where the phase is zero
  double sigma = 0;         ///< its standard deviation, in samples
  double slope_rad = 0;     ///< of the phase, by sample
  std::size_t samples = 0;  ///< that the line rests upon
};

/// The sample at which what arrives comes from a beam's axis. The halves of an array, both steered along the
/// axis, receive what comes from beside it with phases of opposite signs: over a slanting seabed the phase of
/// `product`, one half's signal times the other's conjugate, goes through zero evenly. The first line is
/// the one with which the product adds up best, which no wrapping disturbs; then least squares, weighed by
/// the product's modulus, within the main lobe. The standard deviation is that of the line's residuals. None
/// where fewer than four independent looks are within the lobe (at nadir the seabed comes from all of it at
/// once), where the phase turns by less than half a radian, or turns to zero outside of the window.
std::optional<SplitBeamDetection> split_beam_zero(std::span<const std::complex<double>> product,
                                                  const SplitBeamSearch& search);

}  // namespace tubefoot
