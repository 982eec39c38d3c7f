// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <vector>

#include "sensors/signals/aperture_window.hpp"
#include "sensors/signals/element_signals.hpp"

namespace tubefoot {

/// A waveform as it is sampled, from its beginning: complex baseband [s^-1/2].
std::vector<std::complex<double>> replica(const TransmitWaveform& waveform, const SignalSampling& sampling);

/// Pulse compression: y(t) = integral of s(t + u) conj(g(u) w(u)) du, so that an echo that begins at tau
/// peaks at tau, with its phase, and with its amplitude f/(out home). A window lowers a chirp's range side
/// lobes (its frequencies pass one after the other); the replica is normalised so that the peak stays. The
/// replica is of a platform at rest: a Doppler shift d moves the peak of a chirp of rate k by -d/k and lowers
/// it (docs/beamforming.md). The waveform must be sampled by check_sampled(); with flanks (taper above 0)
/// the sum over samples is the integral to the aliased rest of its spectrum. Throws std::invalid_argument for
/// signals that were filtered before, and as check().
ElementSignals matched_filtered(const ElementSignals& signals, const ApertureWindow& window = {});

}  // namespace tubefoot
