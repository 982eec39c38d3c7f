// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/ping_sums.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// The part of a transmission's echoes that comes over mirrors and by second scatterings, by order, of all
/// sensors of the transmission that have such paths. Throws InputError at the sensor's place for too many
/// images.
void add_paths(const Transmission& transmission, PingSums& sums);

}  // namespace tubefoot
