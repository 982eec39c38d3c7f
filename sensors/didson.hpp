// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/sensor.hpp"

namespace tubefoot {

/// Acoustic camera with ideal rectangular beams: equal azimuth cells about the camera's up axis, each over
/// the whole elevation. Beam 0 is the port-most. (A recorder that wants starboard first, as DDF does, turns
/// them.)
class Didson : public Sensor {
 public:
  /// Throws std::invalid_argument for a sector, a window or counts that make no camera.
  explicit Didson(const SensorDescription& description);
};

}  // namespace tubefoot
