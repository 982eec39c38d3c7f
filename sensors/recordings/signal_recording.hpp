// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "scene/trajectory.hpp"
#include "sensors/recordings/ping_energies.hpp"

namespace tubefoot {

/// What the elements of a recording's sensor receive, with phase: what signals.nc and beams are made of.
struct SignalRecording {
  /// [ping][receiver][sample][real, imaginary], W^1/2 for a source of 1 J/sr at 1 m; complex baseband as the
  /// sensor's SignalModel samples it. They lie elsewhere, in memory or, as one channel, packed.
  std::span<const double> values{};
  std::shared_ptr<const PackedPings> packed{};  ///< in place of `values`
  /// Certified half-widths of these, in the same places; none: not certified.
  std::span<const double> bounds{};
  std::shared_ptr<const PackedPings> packed_bounds{};
  std::shared_ptr<const void> keeper{};  ///< keeps both in memory; null where somebody else does
  /// Where the sensor's carrier is at any time of the pings; of a sensor that is turned to look at something,
  /// where it is itself.
  std::vector<Trajectory::Sample> track{};
};

}  // namespace tubefoot
