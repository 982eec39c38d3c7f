// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "sensors/receiver/receiver.hpp"
#include "sensors/recordings/heard.hpp"
#include "sensors/recordings/recording.hpp"
#include "sensors/recordings/run_context.hpp"

namespace tubefoot {

/// The receiver that a sensor's description asks for. With a pulse length its levels are those of that pulse.
ReceiverChain receiver_of(const Recording& recording, const RunContext& run);

/// The energies [J] of a ping as the sensor's receiver has them, [beam][sample]: spread over the pulse, then
/// through receiver_of(). Every file that a sonar would write is made of these; echoes.nc is not.
std::vector<double> received(const Recording& recording, const RunContext& run, std::size_t ping);

/// The same for pictures; nothing where the receiver leaves energies as they are.
std::optional<Heard> heard_by(const Recording& recording, const RunContext& run);

}  // namespace tubefoot
