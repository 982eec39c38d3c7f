// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/scattering/beam_pattern.hpp"

// Peaks of beam patterns, and the directions in which their gain exceeds a limit.
namespace tubefoot {

/// Returns the largest product of both gains over all directions, for transmitter and receiver at one
/// position.
double two_way_peak(const TransmitPattern& sent, const Directivity& received);

/// Returns, per beam, the two-way gain that is `level_db` below the two-way peak of the beam
/// (BeamPatterns::least). With `apart`, transmitter and receiver see a point in different directions, so the
/// peak is the product of both one-way peaks.
std::vector<double> gains_below_peak(const BeamPatterns& patterns, double level_db, bool apart);

/// Returns, per beam, the receive gain that is `level_db` below the receive pattern's peak.
std::vector<double> receive_gains_below_peak(const BeamPatterns& patterns, double level_db);

struct CosineRange {
  double lo = -1, hi = 1;
};
/// Returns a range of cosines outside of which a pattern's gain is less than `least`. The gain may also be
/// less inside the range.
CosineRange cosines_of_gain(const Directivity& pattern, double least);

}  // namespace tubefoot
