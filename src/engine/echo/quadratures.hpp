// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/echo/echo.hpp"

// Quadratures of integrate() (echo.hpp), which validates their arguments.
namespace tubefoot {

/// Whether a surface returns no energy.
inline bool is_silent(const SurfaceProperties& seabed) {
  return seabed.scattering == nullptr && seabed.mu == 0;
}

/// With how.by_owner, parts go to the sink instead of the echo. `buffer`: see integrate_echo().
Echo integrate_one_apex(const CommonVisibility& visibility, const ReceiveBeams& beams,
                        const RangeSamples& samples, const EchoModel& model, const Quadrature& how,
                        const Sink<double>& sink, std::vector<double> buffer);
void integrate_two_apexes(const CommonVisibility& visibility, const ReceiveBeams& beams,
                          const RangeSamples& samples, const EchoModel& model, const Quadrature& how,
                          const Sink<double>& sink);
/// Bistatic, with a binning other than exact.
void integrate_whole(const CommonVisibility& visibility, const ReceiveBeams& beams,
                     const RangeSamples& samples, const EchoModel& model, Binning binning,
                     const Sink<double>& sink);
/// Bistatic, for hits of rays.
void integrate_hits(const CommonVisibility& visibility, const ReceiveBeams& beams,
                    const RangeSamples& samples, const EchoModel& model, const Sink<double>& sink);

}  // namespace tubefoot
