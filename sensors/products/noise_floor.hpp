// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "sensors/products/products.hpp"

namespace tubefoot {

/// The time-varied gain that a sensor's description asks for.
std::optional<TimeVariedGain> gain_of(const Recording& recording);

/// By sample, the energy [J] from which on an echo stands out of the receiver's noise, after the receiver's
/// gain: 16 times the noise's mean, which noise alone reaches in one sample of 9 million. 0 without noise.
std::vector<double> noise_floor_j(const Recording& recording, const RunContext& run);

}  // namespace tubefoot
