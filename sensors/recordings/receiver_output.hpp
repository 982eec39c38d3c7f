// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace tubefoot {

/// The energies after a sensor's receiver, for pictures of the instrument's display.
struct ReceiverOutput {
  std::function<std::vector<double>(std::size_t ping)> energy_of;  ///< [beam][sample], J; thread-safe
  bool has_gain = false;  ///< true if the energies include the receiver's own time-varied gain
  std::string said;       ///< caption for readers: "as received: speckle, noise"
};

}  // namespace tubefoot
