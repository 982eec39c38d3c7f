// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

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

/// A parameter of a scene, by the velocities of what it moves, per unit of the parameter.
struct SignalParameter {
  /// Velocities of a visible polygon, relative to the origin of the visible polygons.
  struct Polygon {
    std::vector<glm::dvec3> corners;  ///< in the order of VisiblePolygons::corners()
    glm::dvec3 normal{0};             ///< of the unit normal
    double distance = 0;              ///< of the origin from the plane
  };
  std::vector<Polygon> polygons{};              ///< in the order of VisiblePolygons::patches; empty: at rest
  std::vector<glm::dvec3> transmit, receive{};  ///< of the ends of channels; empty: at rest
  double by_sound_speed = 0;                    ///< relative change of the sound speed
  double by_absorption = 0;                     ///< of the one-way absorption in dB/m
};

/// Derivatives of smooth_signals() by parameters, for polygons that keep their corners. The result of a
/// parameter has the layout of the signals. Throws the exceptions of smooth_signals(). It also throws
/// std::invalid_argument for a surface or channel that CertifiedSmoothSignals::can_bound() rejects, and for
/// a pulse with jumps or without a slope. Source: docs/notes/gradients.md.
std::vector<ChannelSignals> smooth_signal_derivatives(
    const VisiblePolygons& patches, const CoherentReceiver& receiver, const EchoModel& model,
    const std::function<const SmoothSurface*(FacetId)>& surface_of,
    std::span<const SignalParameter> parameters, double tolerance = 1e-3);

}  // namespace tubefoot
