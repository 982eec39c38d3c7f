// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "engine/signal/certified_signals.hpp"
#include "run/ping_sums.hpp"
#include "run/transmission.hpp"

// What the elements of arrays receive, with phase (docs/signals.md): kept beside the energies of their
// sensors, as these see them.
namespace tubefoot {

/// Where a ping store keeps the signals of a sensor: as one more sensor, that fires with it.
std::size_t place_of_signals(const Survey& survey, std::size_t sensor);
/// How many such places there are: none where no sensor has signals.
std::size_t places_of_signals(const Survey& survey);
/// Adds them to a layout that has the sensors themselves.
void add_signals(StoreLayout& layout, const Survey& survey, const std::vector<ChosenEchoes>& chosen);

/// The scatterers of a survey's ground, by its scene and by what its arrays can tell apart. The scene has an
/// array.
SurfaceField surface_field_of(const Survey& survey);

/// A transmission's ends as its elements are at it: a channel for each receiver, local frame.
std::vector<SignalChannel> signal_channels(const Transmission& transmission, std::size_t sensor);

/// Hands recordings of sensors that have signals these, of the pings that are chosen.
void attach_signals(std::vector<Recording>& recordings, const Survey& survey,
                    const std::vector<ChosenEchoes>& chosen, const std::shared_ptr<PingStore>& store);

/// What the elements of a sensor receive of a transmission, about the frequency that it mixes with.
/// `history`: what its tubes see; not read of those that see for themselves, or whose receiver is apart. With
/// bounds where the run asks for them, infinite where a sample may hold what has none. Throws InputError for
/// what has no phases, and for grounds of too many scatterers.
CertifiedSignals signals_received(const Transmission& transmission, std::size_t sensor,
                                  const History& history);

/// The part of a transmission's echoes that its elements record.
void add_signals(const Transmission& transmission, PingSums& sums);

}  // namespace tubefoot
