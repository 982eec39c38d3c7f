// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/model/sensor.hpp"

namespace tubefoot {

/// Acoustic camera: a fan of beams about the camera's up axis, each over the whole elevation. Beam 0 is the
/// port-most. (A recorder that wants starboard first, as DDF does, turns them.)
///
/// A frame is one shot, or `cycles` of them: cycle k has the beams k, k + cycles, k + 2 cycles, ...
/// Ideal beams take their own sectors only. With a receive pattern every shot lights the whole fan and
/// its margins, and the beams of its cycle hear all of that.
class Didson : public Sensor {
 public:
  /// Throws std::invalid_argument for a sector, a window, counts or cycles that make no camera.
  explicit Didson(const SensorDescription& description);

 private:
  /// What is looked at, in angles about the camera's axes.
  struct Sector {
    std::vector<double> borders_rad;  ///< of the beams
    double half_width_rad, half_height_rad;
  };
  Shot shot_of(std::size_t cycle, const Sector& sector) const;
};

}  // namespace tubefoot
