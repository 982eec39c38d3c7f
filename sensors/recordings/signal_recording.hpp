// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "scene/trajectory.hpp"
#include "sensors/recordings/recorded_channel.hpp"

namespace tubefoot {

/// Signals of the elements of a recording's sensor, with phase: the input of signals.nc and of beams.
struct SignalRecording {
  /// [ping][receiver][sample][real, imaginary], W^1/2 for a source of 1 J/sr at 1 m: complex baseband with
  /// the sampling of the sensor's SignalModel.
  RecordedChannel pressure{};
  /// Certified half-widths of these values, in the same order; empty: not certified.
  RecordedChannel bound{};
  /// A derivative of these values by a parameter of the scene, in the same order.
  struct Derivative {
    std::string parameter, units, meaning;
    RecordedChannel channel;
  };
  std::vector<Derivative> derivatives{};
  /// Track of the sensor's carrier over the pings. For a sensor that is turned towards a target, it is the
  /// track of the sensor itself.
  std::vector<Trajectory::Sample> track{};
};

}  // namespace tubefoot
