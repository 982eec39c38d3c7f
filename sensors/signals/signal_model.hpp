// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/signals/element_signals.hpp"

namespace tubefoot {

/// How a sonar's elements send and receive: what of signals does not depend on where it is.
struct SignalModel {
  /// On the sensor's own axes, from the place of its transmitter; receivers from that of its receiver, where
  /// this is apart.
  ElementArray array;
  TransmitWaveform waveform;
  SignalSampling sampling;
  /// It stands still from a ping to the next one; else it moves while sound is in progress.
  bool stop_and_hop = true;
  /// Each receiver receives what the transmitter and its own place both see; else all receive what is seen
  /// from the one place of the sensor, or the two of one whose receiver is apart.
  bool own_views = false;
  /// Of signals, about, relative to what they would be without interference.
  double tolerance = 1e-3;

  /// How far an element is from the place that the tubes begin at [m].
  double farthest_element_m() const;
};

}  // namespace tubefoot
