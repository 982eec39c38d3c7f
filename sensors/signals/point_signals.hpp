// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "sensors/signals/element_signals.hpp"

namespace tubefoot {

/// A point at rest that scatters alike in all directions.
struct PointScatterer {
  glm::dvec3 position_m{0};           ///< in the scene's frame
  std::complex<double> strength = 1;  ///< f of p_s = p_i f e^{ikr}/r [m]; target strength 10 log |f|^2
};

/// What the elements receive of points in open water without absorption: no occlusion, no second scattering.
/// An echo that a receiver has at t left the transmitter at t - tau, exactly (path_received_at): delays,
/// phases, and the stretch of the waveform by moving ends are those of the way of sound; spreading is
/// 1/(out home). Whoever is asked for what a simulation of surfaces should give of small ones has here its
/// closed form. Throws as silent_signals(), and for a scatterer that is not finite or lies at an element.
ElementSignals point_signals(const std::vector<PointScatterer>& targets, const ElementArray& array,
                             const TransmitWaveform& waveform, const SignalSampling& sampling,
                             const VehicleMotion& motion, double sound_speed_m_s);

}  // namespace tubefoot
