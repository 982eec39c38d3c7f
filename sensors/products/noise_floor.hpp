// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "sensors/products/received.hpp"

namespace tubefoot {

/// The time-varied gain in a sensor's description, for a transmit sector (Recording::sector_of).
std::optional<TimeVariedGain> gain_of(const Recording& recording, std::size_t sector = 0);

/// By sample, the least energy [J/m^2] of an echo that is distinguishable from the receiver's noise, after
/// the receiver's gain. It is 16 times the noise's mean, which noise alone reaches in one sample of 9
/// million. It is 0 without noise.
std::vector<double> noise_floor_j(const Recording& recording, const RunContext& run, std::size_t sector = 0);

}  // namespace tubefoot
