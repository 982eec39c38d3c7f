// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "engine/signal/coherent_signals.hpp"
#include "engine/signal/smooth_surface.hpp"

namespace tubefoot {

/// What channels receive of smooth facets, in the Kirchhoff approximation: the pressure of
/// smooth_amplitude.hpp at each of the pulse's frequencies, at baseband about the carrier, in the joules and
/// phases of element_signals(), so that both add up. Patterns and absorption are factors of a piece, taken at
/// its centroid and middle path; patches are cut where patterns change much over them. Patches whose facet
/// has no surface (null) are silent.
///
/// Over the pulse's band a piece's amplitude, less the phase of its middle path, is a polynomial of few
/// nodes; pieces whose paths differ by more than those resolve are cut, which changes nothing (law Q7).
/// `tolerance`: of a piece's amplitude at each frequency of the band, relative to the largest that a piece of
/// its area and place can have; from 1e-9 to 0.1. A band must not reach down to frequency 0.
/// Law Q8 (pulses): the signal is add_pulse_echo()'s. Throws as the functions of coherent_signals.hpp do. The
/// same bits for any number of threads.
ChannelSignals smooth_signals(const VisiblePolygons& patches, const CoherentReceiver& receiver,
                              const EchoModel& model,
                              const std::function<const SmoothSurface*(FacetId)>& surface_of,
                              double tolerance = 1e-3);

}  // namespace tubefoot
