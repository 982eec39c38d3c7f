// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "scene/trajectory.hpp"
#include "sensors/recordings/ping_energies.hpp"

namespace tubefoot {

/// Signals of the elements of a recording's sensor, with phase: the input of signals.nc and of beams.
struct SignalRecording {
  /// [ping][receiver][sample][real, imaginary], W^1/2 for a source of 1 J/sr at 1 m: complex baseband with
  /// the sampling of the sensor's SignalModel. The values are stored elsewhere, in memory or packed as one
  /// channel.
  std::span<const double> values{};
  std::shared_ptr<const PackedPings> packed{};  ///< in place of `values`
  /// Certified half-widths of these values, in the same order; empty: not certified.
  std::span<const double> bounds{};
  std::shared_ptr<const PackedPings> packed_bounds{};
  std::shared_ptr<const void> keeper{};  ///< owner of the memory of both; null if another object owns it
  /// Track of the sensor's carrier over the pings. For a sensor that is turned towards a target, it is the
  /// track of the sensor itself.
  std::vector<Trajectory::Sample> track{};
};

}  // namespace tubefoot
