// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sensors/receiver/receiver.hpp"
#include "sensors/recordings/receiver_output.hpp"
#include "sensors/recordings/recording.hpp"
#include "sensors/recordings/run_context.hpp"

namespace tubefoot {

/// The receiver that a sensor's description asks for. With a pulse length its levels are those of that pulse.
ReceiverChain receiver_of(const Recording& recording, const RunContext& run);

/// The pings of a recording as the sensor's receiver has them: energies spread over the pulse, then through
/// receiver_of(). Every file that a sonar would write is made of these; echoes.nc is not. What is the same of
/// all pings is made once. Thread-safe; the recording must outlive it.
class ReceivedPings {
 public:
  ReceivedPings(const Recording& recording, const RunContext& run);
  /// With a receiver that leaves energies as they are.
  static ReceivedPings ideal(const Recording& recording) {
    return ReceivedPings(recording, ReceiverChain({}), {});
  }

  /// Energies [J], [beam][sample].
  std::vector<double> of(std::size_t ping) const;
  /// Those of one beam, up to the last that is above 0. `energies`: all of that ping.
  std::vector<double> of_beam(std::size_t ping, std::size_t beam, std::span<const double> energies) const;
  const ReceiverChain& chain() const { return chain_; }

 private:
  ReceivedPings(const Recording& recording, const ReceiverChain& chain, std::optional<double> pulse_us);

  const Recording* recording_;
  ReceiverChain chain_;
  std::vector<double> gains_;       ///< by sample
  std::optional<double> extent_m_;  ///< of the pulse
};

/// The same for pictures; nothing where the receiver leaves energies as they are.
std::optional<ReceiverOutput> receiver_output_of(const Recording& recording, const RunContext& run);

}  // namespace tubefoot
