// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "engine/paths/coherent_paths.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// What is done with what a transmission's channels receive over mirrors.
struct SignalPaths {
  std::function<void(const CoherentPath&)> scattered{};   ///< once; its references end with the call
  std::function<void(const CoherentArrival&)> arrived{};  ///< without scattering
};

/// Hands out what channels of a sensor receive of a transmission over mirrors, of the orders that [paths]
/// asks for; the straight way to a facet and back, order 1 as well, is the transmission's own
/// (Transmission::trace()). `channels`: near the sensor's place, local frame. Nothing in a scene without
/// mirrors. Throws InputError for water that refracts, for second scatterings, and where there are too many
/// images.
void for_signal_paths(const Transmission& transmission, std::size_t sensor,
                      std::span<const SignalChannel> channels, const SignalPaths& take);

}  // namespace tubefoot
