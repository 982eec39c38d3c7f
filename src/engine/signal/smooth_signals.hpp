// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "engine/signal/coherent_signals.hpp"
#include "engine/signal/smooth_surface.hpp"

namespace tubefoot {

/// Signals that channels receive from smooth facets, in the Kirchhoff approximation. The function evaluates
/// the pressure of smooth_amplitude.hpp at the frequencies of the pulse, at baseband about the carrier.
/// Units and phases are those of element_signals(), so both signals can be added. Patterns and absorption
/// are factors of a piece at its centroid and mean path. Polygons are cut if patterns change much over them.
/// Polygons whose facet has no surface (null) return nothing.
///
/// Over the band of the pulse, the amplitude of a piece relative to the phase of its mean path is a
/// polynomial with few nodes. Pieces with larger path differences are cut, which does not change the result
/// (law Q7). `tolerance` (1e-9 to 0.1): error of a piece's amplitude at each frequency of the band. It is
/// relative to the largest amplitude of a piece with the same area and place. The band must not include the
/// frequency 0.
/// Law Q8 (pulses): the signal equals that of add_pulse_echo(). Throws the exceptions of
/// coherent_signals.hpp. The result has the same bits for any number of threads.
ChannelSignals smooth_signals(const VisiblePolygons& patches, const CoherentReceiver& receiver,
                              const EchoModel& model,
                              const std::function<const SmoothSurface*(FacetId)>& surface_of,
                              double tolerance = 1e-3);

}  // namespace tubefoot
