// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "run/contributions.hpp"
#include "run/ping_sums.hpp"
#include "run/transmission.hpp"
#include "sensors/recordings/signal_recording.hpp"

// This header declares the derivatives of signals of smooth surfaces by parameters of the scene
// (docs/gradients.md). They are output channels of sensors with signals.
namespace tubefoot {

/// Returns the output channels of the derivatives of a sensor's signals. Empty if the run requests no
/// derivatives, and for a sensor or scene that has none.
std::vector<OutputChannel> signal_gradient_channels(const Survey& survey, std::size_t sensor,
                                                    const RunRequest& request);

/// Returns a warning for each sensor whose signals of smooth surfaces have no derivatives, with the reason.
std::vector<std::string> missing_signal_gradients(const Survey& survey, const RunRequest& request);

/// Returns the derivatives of a sensor's signals in a store.
std::vector<SignalRecording::Derivative> recorded_signal_gradients(const Survey& survey, std::size_t sensor,
                                                                   const std::shared_ptr<PingStore>& store);

/// Adds the derivatives of a transmission's signals.
void add_signal_gradients(const EchoContribution& plan, const Transmission& transmission, PingSums& sums);

}  // namespace tubefoot
