// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

#include "run/ping_sums.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// A part of what the sensors of a transmission receive of it: adds its energies, bounds and counts to the
/// ping's.
struct EchoPart {
  std::string_view name;
  void (*add)(const Transmission& transmission, PingSums& sums);
};

/// The parts that make up the echoes of a group's transmissions, in the order in which they are added: chosen
/// here alone, by what the scene has and what is asked for.
std::vector<EchoPart> echo_parts(const Transmissions& transmissions, const SharedTransmissions& group);

/// What a transmission's tubes see of its one ground. The cycles of a camera that stands still light the same
/// tubes from the same place: what is seen of the surface that they share is looked for once, as it is for
/// several parts of one transmission.
const History& traced(const Transmission& transmission, PingSums& sums);

}  // namespace tubefoot
