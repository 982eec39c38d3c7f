// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <memory>
#include <span>
#include <vector>

#include "engine/gradient/echo_gradient.hpp"
#include "engine/signal/certified_signals.hpp"
#include "run/contributions.hpp"
#include "run/ping_sums.hpp"
#include "run/transmission.hpp"

// This header declares the signals that the elements of arrays receive, with phase (docs/signals.md). They
// are output channels of their sensors, in addition to the energies.
namespace tubefoot {

/// Returns the scatterers of a survey's surfaces. Their properties follow from the scene and from the
/// resolution of its arrays. The scene must have an array.
SurfaceField surface_field_of(const Survey& survey);

/// Returns the ends of a transmission at the positions of its elements: one channel per receiver, in the
/// local frame.
std::vector<SignalChannel> signal_channels(const Transmission& transmission, std::size_t sensor);

/// Converts values to the form of an output channel: [receiver][sample][real, imaginary].
std::vector<double> parts_of(std::span<const std::complex<double>> values);

/// Attaches the signals to the recordings of sensors that have them, for the selected pings.
void attach_signals(std::vector<Recording>& recordings, const Survey& survey,
                    const std::vector<ChosenEchoes>& chosen, const std::shared_ptr<PingStore>& store);

/// Returns the signals that the elements of a sensor receive from a transmission, relative to the mixing
/// frequency. `history`: history of the transmission's tubes. It is not used for elements with views of
/// their own, and not for separate receivers. The result has bounds if the run requests them; a bound is
/// infinite if the sample may contain a contribution without a bound. Throws InputError for features without
/// phases, and for surfaces with too many scatterers.
CertifiedSignals signals_received(const Transmission& transmission, std::size_t sensor,
                                  const History& history);

/// Returns the derivatives of these signals by parameters, for smooth surfaces. See
/// smooth_signal_derivatives().
std::vector<ChannelSignals> signal_derivatives(const Transmission& transmission, std::size_t sensor,
                                               const History& history,
                                               std::span<const EchoParameter> parameters);

/// Adds the part of a transmission's echoes that its elements record.
void add_signals(const EchoContribution& plan, const Transmission& transmission, PingSums& sums);

}  // namespace tubefoot
