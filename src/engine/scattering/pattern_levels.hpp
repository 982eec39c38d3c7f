// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/scattering/beam_pattern.hpp"

// Where the gain of beam patterns is near its peak.
namespace tubefoot {

/// Largest product of both gains over all directions, transmitter and receiver being at one place.
double two_way_peak(const TransmitPattern& sent, const Directivity& received);

/// By beam: the two-way gain that lies `level_db` below the two-way peak of the beam (BeamPatterns::least).
/// `apart`: transmitter and receiver see a place in directions of their own, so that the peak is the product
/// of both one-way peaks.
std::vector<double> gains_below_peak(const BeamPatterns& patterns, double level_db, bool apart);

/// By beam: the receive gain that lies `level_db` below the receive pattern's peak.
std::vector<double> receive_gains_below_peak(const BeamPatterns& patterns, double level_db);

struct CosineRange {
  double lo = -1, hi = 1;
};
/// Outside of it a pattern's gain is less than `least`; it may be less inside, too.
CosineRange cosines_of_gain(const Directivity& pattern, double least);

}  // namespace tubefoot
