// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/echo/echo.hpp"

namespace tubefoot {

/// Sees what a footprint has just added to an echo's energies, and may take it away.
using FootprintTaker = std::function<void(const Footprint& footprint, std::span<double> energy)>;

/// integrate_echo() that lets `taker`, if there is one, look after each footprint.
Echo integrate_echo(const History& history, std::span<const std::uint32_t> beam_of_tube, int beams,
                    const RangeSamples& samples, const EchoLaw& law, Binning binning,
                    const FootprintTaker& taker);

/// What one footprint adds to one range sample of one beam.
struct Contribution {
  std::uint32_t footprint = 0;  ///< in FootprintSet::footprints
  std::uint32_t beam = 0, sample = 0;
  double energy_j = 0;
};

/// Which footprints made which samples: the terms that integrate_echo() adds up, with the same arguments,
/// ordered by footprint, beam and sample. For each beam and sample they sum to the echo's energy but for
/// rounding (with beam patterns: rounding of their peak).
///
/// With patterns every footprint is heard by every beam of its fan. `least_share` leaves out what is less
/// than this times the energy of its beam and sample in `echo` (which integrate_echo() made), but never a
/// footprint's largest contribution; 0 keeps everything that is not zero. The footprints must be measured
/// (measure.hpp). Throws as integrate_echo().
std::vector<Contribution> contributions(const History& history, std::span<const std::uint32_t> beam_of_tube,
                                        const RangeSamples& samples, const EchoLaw& law, Binning binning,
                                        const Echo& echo, double least_share = 0);

}  // namespace tubefoot
