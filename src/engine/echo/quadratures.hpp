// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/echo/lit_echo.hpp"

// The quadratures behind integrate() (echo.hpp), which has looked at what they are given.
namespace tubefoot {

/// Nothing comes back from there.
inline bool is_silent(const SurfaceProperties& seabed) {
  return seabed.scattering == nullptr && seabed.mu == 0;
}

/// Parts whose owner is asked for go to the sink instead. `room`: as integrate_lit_echo() has it.
LitEcho integrate_one_apex(const CommonVisibility& visibility, const ReceiveBeams& beams,
                           const RangeSamples& samples, const EchoModel& model, const Quadrature& how,
                           const Sink<double>& sink, std::vector<double> room);
void integrate_two_apexes(const CommonVisibility& visibility, const ReceiveBeams& beams,
                          const RangeSamples& samples, const EchoModel& model, const Quadrature& how,
                          const Sink<double>& sink);
/// Of two apexes, by a binning that is not exact.
void integrate_whole(const CommonVisibility& visibility, const ReceiveBeams& beams,
                     const RangeSamples& samples, const EchoModel& model, Binning binning,
                     const Sink<double>& sink);
/// Of two apexes, what rays met.
void integrate_hits(const CommonVisibility& visibility, const ReceiveBeams& beams,
                    const RangeSamples& samples, const EchoModel& model, const Sink<double>& sink);

}  // namespace tubefoot
