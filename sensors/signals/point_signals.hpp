// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "sensors/signals/element_signals.hpp"

namespace tubefoot {

/// A point at rest that scatters equally in all directions.
struct PointScatterer {
  glm::dvec3 position_m{0};           ///< in the scene's frame
  std::complex<double> strength = 1;  ///< f of p_s = p_i f e^{ikr}/r [m]; target strength 10 log |f|^2
};

/// Signals that the elements receive from points in open water without absorption, occlusion and second
/// scattering. An echo that a receiver has at t left the transmitter at t - tau, exactly (path_received_at).
/// Delays, phases, and the stretch of the waveform by moving ends follow from the path of sound. Spreading
/// is 1/(r_tx r_rx), with the ranges of both legs. This closed form is a reference for simulations of small
/// surfaces. Throws as silent_signals() does, and for a scatterer that is not finite or lies at an element.
ElementSignals point_signals(const std::vector<PointScatterer>& targets, const ElementArray& array,
                             const TransmitWaveform& waveform, const SignalSampling& sampling,
                             const VehicleMotion& motion, double sound_speed_m_s);

}  // namespace tubefoot
