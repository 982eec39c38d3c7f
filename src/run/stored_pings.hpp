// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "run/checkpoint/ping_store.hpp"
#include "sensors/recordings/ping_energies.hpp"

// A store's pings, as recordings read them.
namespace tubefoot {

/// The energies of a sensor, or their bounds, of a store that keeps them packed, which lives as long; null
/// for one in memory.
std::shared_ptr<const PackedPings> packed_pings(const std::shared_ptr<const PingStore>& store,
                                                std::size_t sensor, bool bound = false);
/// The energies of a sensor, all pings' one behind the other; empty where the store keeps them packed.
std::span<const double> in_memory(const std::shared_ptr<const PingStore>& store, std::size_t sensor);

}  // namespace tubefoot
