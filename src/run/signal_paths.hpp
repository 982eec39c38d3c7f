// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "engine/paths/coherent_paths.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// Callbacks for the paths over mirrors by which a transmission's channels receive sound.
struct SignalPaths {
  /// for a path with one scattering; its references are valid during the call
  std::function<void(const CoherentPath&)> scattered{};
  std::function<void(const CoherentArrival&)> arrived{};  ///< for a path without scattering
};

/// Calls `take` for the paths over mirrors by which the channels of a sensor receive a transmission. The
/// paths have the orders that [paths] requests. The direct path to a facet and back, which also has order 1,
/// belongs to Transmission::trace(). `channels`: near the sensor's position, in the local frame. Does
/// nothing in a scene without mirrors. Throws InputError for refracting water, for second scatterings, and
/// for too many images.
void for_signal_paths(const Transmission& transmission, std::size_t sensor,
                      std::span<const SignalChannel> channels, const SignalPaths& take);

}  // namespace tubefoot
