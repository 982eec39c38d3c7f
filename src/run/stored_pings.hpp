// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "run/checkpoint/ping_store.hpp"
#include "sensors/recordings/recorded_channel.hpp"

// This header gives recordings access to the pings of a store.
namespace tubefoot {

/// Returns an output channel of a sensor. The result keeps the store alive. It is empty if the store has no
/// such channel.
RecordedChannel recorded_channel(const std::shared_ptr<const PingStore>& store, std::size_t sensor,
                                 const std::string& channel);

}  // namespace tubefoot
