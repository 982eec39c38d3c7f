// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/signals/element_signals.hpp"

namespace tubefoot {

/// Transmit and receive properties of a sonar's elements that do not depend on its position.
struct SignalModel {
  /// Positions on the sensor's own axes, relative to its transmitter. Receivers of a bistatic sensor are
  /// relative to its receiver.
  ElementArray array;
  TransmitWaveform waveform;
  SignalSampling sampling;
  /// True if the sensor stands still from a ping to the next one. Otherwise it moves during propagation.
  bool stop_and_hop = true;
  /// True if each receiver receives the common visibility of the transmitter and its own position. Otherwise
  /// all receive the part that is visible from the sensor's position, or from both positions of a bistatic
  /// sensor.
  bool own_views = false;
  /// Approximate tolerance of the signals, relative to their value without interference.
  double tolerance = 1e-3;

  /// Largest distance of an element from the apex of the tubes [m].
  double farthest_element_m() const;
};

}  // namespace tubefoot
