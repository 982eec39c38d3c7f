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

/// What channels receive of one seabed: the signal of channel a at time t is
///     y_a(t) = integral over the patches of sqrt(sigma) S A_a e^{ikL_a} g(t - L_a / c) dA,
/// S the seabed's white field, A_a what density.hpp and patterns make, L_a the transmit and receive legs, k
/// the carrier's wavenumber. All channels see the same patches.
struct CoherentReceiver {
  std::vector<SignalChannel> channels;
  BasebandPulse pulse;
  SignalTimes times;
  double carrier_hz = 0, sound_speed_m_s = 1500;
};

/// Complex samples, channel by channel.
struct ChannelSignals {
  std::size_t channels = 0, samples = 0;
  std::vector<std::complex<double>> value;

  std::complex<double> at(std::size_t channel, std::size_t sample) const {
    return value[channel * samples + sample];
  }
};

/// Throws std::invalid_argument that says what is wrong and what to do.
void check(const CoherentReceiver& receiver, const EchoModel& model);

// Each throws std::invalid_argument that says what is wrong and what to do: no channel, a pulse that the
// samples do not hold, a carrier or a sound speed that is not above 0, a field that is none. `tolerance`: of
// covariances, about, relative to what they would be without interference and with all of a pulse's
// frequencies in phase (of a chirp: after its matched filter).

/// Channels by a field that belongs to the surface. The field's scatterers are summed up as moments over
/// pieces of the seabed on which channels are polynomials but for a phase that all have, so that a scatterer
/// costs the same for any number of channels and samples. A scatterer's own echo is right to about
/// `tolerance` of its size. The same bits for any number of threads.
ChannelSignals element_signals(const VisiblePolygons& patches, const CoherentReceiver& receiver,
                               const EchoModel& model, const SurfaceField& field, double tolerance = 1e-3);

/// Channels with the same covariances, of a seabed that nobody sees twice: from nodes of Gauss rules, each
/// with a random amplitude of its own. Far fewer are needed than a field has scatterers. `ping` tells draws
/// apart.
ChannelSignals drawn_signals(const VisiblePolygons& patches, const CoherentReceiver& receiver,
                             const EchoModel& model, std::uint64_t seed, std::uint32_t ping,
                             double tolerance = 1e-3);

/// One sample of one channel.
struct SignalSample {
  std::uint32_t channel = 0, sample = 0;
};
/// Covariances E[y y*] of samples, Hermitian and positive semi-definite by what they are: sums over the nodes
/// of seabed_scatterers(). Work grows as the number of nodes times the square of how many of the samples
/// receive a node.
CovarianceMatrix signal_covariances(const VisiblePolygons& patches, const CoherentReceiver& receiver,
                                    std::span<const SignalSample> samples, const EchoModel& model,
                                    double tolerance = 1e-6);

/// Circular Gaussian samples of a factor's covariances; `draw` tells draws apart.
std::vector<std::complex<double>> drawn_samples(const LowRankFactor& factor, std::uint64_t seed,
                                                std::uint32_t draw);

}  // namespace tubefoot
