// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/echo/echo.hpp"
#include "geometry/integrals/range_cut.hpp"

namespace tubefoot {

/// An echo, and where in it there may be anything: of a multibeam's, a few samples of each beam.
struct LitEcho {
  Echo echo;
  /// By row of its energies: all samples outside are 0. Empty: any may be lit.
  std::vector<SampleSpan> lit;
};

/// What integrate_echo() makes, bit for bit. `room`: zeros, however many: the energies are made in their
/// memory, since fresh memory costs more than what most echoes put into it.
LitEcho integrate_lit_echo(const CommonVisibility& visibility, const ReceiveBeams& beams,
                           const RangeSamples& samples, const EchoModel& model, Quadrature how,
                           std::vector<double> room);

/// The memory of an echo's energies, set to 0 again.
std::vector<double> cleared_room(LitEcho echo);

}  // namespace tubefoot
