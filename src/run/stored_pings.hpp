// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "run/checkpoint/ping_store.hpp"
#include "sensors/recordings/ping_energies.hpp"

// This header gives recordings access to the pings of a store.
namespace tubefoot {

/// Returns the packed energies of a sensor, or their bounds. The result keeps the store alive. Null for a
/// store in memory.
std::shared_ptr<const PackedPings> packed_pings(const std::shared_ptr<const PingStore>& store,
                                                std::size_t sensor, bool bound = false);
/// Returns the energies of a sensor for all pings in sequence. Empty if the store keeps them packed.
std::span<const double> in_memory(const std::shared_ptr<const PingStore>& store, std::size_t sensor);

}  // namespace tubefoot
