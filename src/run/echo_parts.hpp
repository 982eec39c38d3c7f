// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

#include "run/ping_sums.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// One part of the echoes that the sensors of a transmission receive. `add` adds its energies, bounds and
/// counts to those of the ping.
struct EchoPart {
  std::string_view name;
  void (*add)(const Transmission& transmission, PingSums& sums);
};

/// Returns the parts of the echoes of a group's transmissions, in the order of summation. This function
/// alone chooses the parts, by the features of the scene and the request.
std::vector<EchoPart> echo_parts(const Transmissions& transmissions, const SharedTransmissions& group);

/// Returns the history of a transmission's tubes on its surface mesh. A stationary camera sends the same
/// tubes from the same position in each cycle. On a surface that its cycles share, the history is therefore
/// computed once. It is also computed once for several parts of one transmission.
const History& traced(const Transmission& transmission, PingSums& sums);

}  // namespace tubefoot
