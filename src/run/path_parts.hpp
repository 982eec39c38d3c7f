// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/contributions.hpp"

namespace tubefoot {

/// Adds the echoes of a transmission over mirrors and by second scatterings, by order, for sensors with
/// path_settings(). The second function is for receiver pairs. Throws InputError at the sensor's place in the
/// scene file if there are too many images.
void add_paths(const EchoContribution& plan, const Transmission& transmission, PingSums& sums);
void add_receiver_pair_paths(const EchoContribution& plan, const Transmission& transmission, PingSums& sums);

}  // namespace tubefoot
