// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "engine/echo/bistatic_echo.hpp"
#include "engine/echo/echo.hpp"

namespace tubefoot {

/// What each footprint adds to an echo, over all range samples, in the order of the footprints. Joule per
/// J/sr sent at 1 m, as Echo.
struct FootprintEnergies {
  std::vector<double> all_beams;  ///< in all beams that hear it: these sum to the sum of the echo
  /// In the beam that its tube belongs to. Without patterns no other beam hears it.
  std::vector<double> own_beam;
};

/// The energies that integrate_echo() would put into its bins, by footprint instead. Arguments as there.
FootprintEnergies footprint_energies(const History& history, std::span<const std::uint32_t> beam_of_tube,
                                     int beams, const RangeSamples& samples, const EchoLaw& law,
                                     Binning binning = Binning::exact);

/// The same for a receiver apart: by footprint of the transmitter (`sent`, what trace_bistatic() shared with
/// the receiver is a part of each), what integrate_bistatic_echo() would put into its bins. A footprint's own
/// beam is `beam_of_transmit_tube`'s.
FootprintEnergies footprint_energies(const FootprintSet& sent, const BistaticHistory& history,
                                     std::span<const std::uint32_t> beam_of_transmit_tube,
                                     const BistaticBeams& beams, const RangeSamples& samples,
                                     const EchoLaw& law);

}  // namespace tubefoot
