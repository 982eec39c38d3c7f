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

/// The receiver in a sensor's description, for the echoes of one transmit sector (Recording::sector_of). With
/// a pulse length, its levels are those of that pulse.
ReceiverChain receiver_of(const Recording& recording, const RunContext& run, std::size_t sector = 0);

/// The pings of a recording after the sensor's receiver: energies spread over the pulse, then processed by
/// receiver_of(). All files of received data use them. Data that all pings share are computed once.
/// Thread-safe; the recording must outlive this object.
class ReceivedPings {
 public:
  ReceivedPings(const Recording& recording, const RunContext& run);
  /// With an ideal receiver, which does not change energies.
  static ReceivedPings ideal(const Recording& recording) {
    return ReceivedPings({Sector{ReceiverChain({}), {}, {}}}, recording);
  }

  /// Energies [J/m^2], [beam][sample].
  std::vector<double> of(std::size_t ping) const;
  /// Energies at the lower receiver of a pair, [beam][sample]; of() returns those at the upper receiver.
  std::vector<double> lower_of(std::size_t ping) const;
  /// Energies of one beam, up to the last one above 0. `energies`: all energies of that ping.
  std::vector<double> of_beam(std::size_t ping, std::size_t beam, std::span<const double> energies) const;
  /// The receiver for the echoes of a beam.
  const ReceiverChain& chain(std::size_t beam = 0) const { return sector_of(beam).chain; }

 private:
  /// Data that the beams of a transmit sector share.
  struct Sector {
    ReceiverChain chain;
    std::optional<double> extent_m;  ///< of the pulse
    std::vector<double> gains;       ///< by sample
  };
  static std::vector<Sector> sectors_of(const Recording& recording, const RunContext& run);
  /// Computes the gains of the sectors.
  ReceivedPings(std::vector<Sector> sectors, const Recording& recording);

  const Sector& sector_of(std::size_t beam) const {
    return sectors_.size() == 1 ? sectors_.front() : sectors_[recording_->sector_of(beam)];
  }
  std::size_t samples() const { return sectors_.front().gains.size(); }
  /// The values of a ping, spread over the pulse.
  std::vector<double> spread(std::span<const double> values) const;
  std::vector<double> spread_beam(std::size_t beam, std::span<const double> values) const;
  /// Number of a beam in the sonar, which determines its random numbers.
  std::uint32_t beam_number(std::size_t beam) const;

  const Recording* recording_;
  std::vector<Sector> sectors_;  ///< one, or one per transmit sector
};

}  // namespace tubefoot
