// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/model/sensor.hpp"

namespace tubefoot {

/// Imaging (forward-looking) sonar with any number of ideal rectangular beams: equal azimuth cells about the
/// sensor's up axis, each over the whole elevation. Beam 0 is the port-most.
class Imaging : public Sensor {
 public:
  /// Throws std::invalid_argument for a sector, ranges or counts that make no sonar.
  explicit Imaging(const SensorDescription& description);
};

}  // namespace tubefoot
