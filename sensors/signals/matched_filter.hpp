// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <vector>

#include "sensors/signals/aperture_window.hpp"
#include "sensors/signals/element_signals.hpp"

namespace tubefoot {

/// The sampled waveform from its beginning: complex baseband [s^-1/2].
std::vector<std::complex<double>> replica(const TransmitWaveform& waveform, const SignalSampling& sampling);

/// Pulse compression: y(t) = integral of s(t + u) conj(g(u) w(u)) du. An echo that begins at tau peaks at
/// tau, with its phase. Its amplitude is f/(r_tx r_rx), with the ranges of both legs. A window lowers a
/// chirp's range side lobes, because its frequencies pass one after the other. The replica is normalised so
/// that the window preserves the peak. The replica is that of a platform at rest. A Doppler shift d moves
/// the peak of a chirp of rate k by -d/k and lowers it (docs/notes/signals.md). The waveform must satisfy
/// check_sampled(). With flanks (taper above 0) the sum over samples equals the integral, except for the
/// aliased rest of the spectrum. Throws std::invalid_argument for signals that are already filtered, and as
/// check() does.
ElementSignals matched_filtered(const ElementSignals& signals, const ApertureWindow& window = {});

}  // namespace tubefoot
