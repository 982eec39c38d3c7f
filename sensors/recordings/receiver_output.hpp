// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace tubefoot {

/// What a sensor's receiver makes of the energies: for pictures of what the instrument shows.
struct ReceiverOutput {
  std::function<std::vector<double>(std::size_t ping)> energy_of;  ///< [beam][sample], J; thread-safe
  bool has_gain = false;  ///< a time-varied gain of the receiver's own is in them
  std::string said;       ///< for people: "as received: speckle, noise"
};

}  // namespace tubefoot
