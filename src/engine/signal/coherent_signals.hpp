// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/signal/baseband_pulse.hpp"
#include "engine/signal/low_rank.hpp"
#include "engine/signal/signal_channel.hpp"
#include "engine/signal/surface_field.hpp"
#include "engine/signal/visible_polygons.hpp"

namespace tubefoot {

/// Channels that receive the echo of one seabed. The signal of channel a at time t is
///     y_a(t) = integral over the polygons of sqrt(sigma) S A_a e^{ikL_a} g(t - L_a / c) dA.
/// S is the white field of the seabed, and A_a the amplitude of density.hpp and of the beam patterns. L_a is
/// the length of transmit and receive leg, and k the wavenumber of the carrier. All channels see the same
/// polygons.
struct CoherentReceiver {
  std::vector<SignalChannel> channels;
  BasebandPulse pulse;
  SignalTimes times;
  double carrier_hz = 0, sound_speed_m_s = 1500;
};

/// Complex samples in the order of the channels.
struct ChannelSignals {
  std::size_t channels = 0, samples = 0;
  std::vector<std::complex<double>> value;

  std::complex<double> at(std::size_t channel, std::size_t sample) const {
    return value[channel * samples + sample];
  }
};

/// Throws std::invalid_argument with the cause and a remedy.
void check(const CoherentReceiver& receiver, const EchoModel& model);

// Each function throws std::invalid_argument, with the cause and a remedy, for invalid arguments. These are
// no channel, a pulse that the sampling rate does not resolve, an invalid field, and a carrier or sound
// speed of 0 or less. `tolerance`: approximate error of covariances. It is relative to their values without
// interference and with all frequencies of the pulse in phase (for a chirp: after its matched filter).

/// Signals of a scene-fixed field. The scatterers are summed as moments over pieces of the seabed. On a
/// piece the channels are polynomials times a common phase factor. The cost of a scatterer therefore does
/// not depend on the numbers of channels and samples. The echo of a single scatterer has an error of about
/// `tolerance` of its size. The result has the same bits for any number of threads.
ChannelSignals element_signals(const VisiblePolygons& patches, const CoherentReceiver& receiver,
                               const EchoModel& model, const SurfaceField& field, double tolerance = 1e-3);

/// Independent draws with the same covariances, for a seabed that is observed once. The sources are nodes of
/// Gauss rules with random amplitudes. Far fewer nodes are needed than a field has scatterers. `ping`
/// distinguishes draws.
ChannelSignals drawn_signals(const VisiblePolygons& patches, const CoherentReceiver& receiver,
                             const EchoModel& model, std::uint64_t seed, std::uint32_t ping,
                             double tolerance = 1e-3);

/// One sample of one channel.
struct SignalSample {
  std::uint32_t channel = 0, sample = 0;
};
/// Covariances E[y y*] of samples. They are sums over the nodes of seabed_scatterers(), so the matrix is
/// Hermitian and positive semi-definite. The cost is proportional to the number of nodes times the square of
/// the number of samples that receive a node.
CovarianceMatrix signal_covariances(const VisiblePolygons& patches, const CoherentReceiver& receiver,
                                    std::span<const SignalSample> samples, const EchoModel& model,
                                    double tolerance = 1e-6);

/// Circular Gaussian samples with the covariances of a factor. `draw` distinguishes draws.
std::vector<std::complex<double>> drawn_samples(const LowRankFactor& factor, std::uint64_t seed,
                                                std::uint32_t draw);

}  // namespace tubefoot
