// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/ping_sums.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// Adds the echoes of a transmission over mirrors and by second scatterings, by order, for all sensors of
/// the transmission that have such paths. Throws InputError at the sensor's place in the scene file if there
/// are too many images.
void add_paths(const Transmission& transmission, PingSums& sums);

}  // namespace tubefoot
