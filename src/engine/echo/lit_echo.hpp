// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/echo/echo.hpp"
#include "geometry/integrals/range_cut.hpp"

namespace tubefoot {

/// Echo with the ranges of samples that may be non-zero. For a multibeam these are a few samples per beam.
struct LitEcho {
  Echo echo;
  /// Per row of energies: all samples outside of the span are 0. Empty: any sample may be non-zero.
  std::vector<SampleSpan> lit;
};

/// Returns the same bits as integrate_echo(). `room`: any number of zeros, whose memory is reused for the
/// energies. New memory costs more than the computation of most echoes.
LitEcho integrate_lit_echo(const CommonVisibility& visibility, const ReceiveBeams& beams,
                           const RangeSamples& samples, const EchoModel& model, Quadrature how,
                           std::vector<double> room);

/// Memory of an echo's energies, set to 0 again.
std::vector<double> cleared_room(LitEcho echo);

}  // namespace tubefoot
