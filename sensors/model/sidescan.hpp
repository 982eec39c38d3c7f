// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/model/sensor.hpp"

namespace tubefoot {

/// Sidescan with ideal rectangular beams: beam 0 looks to port, beam 1 to starboard. Each is a fan about the
/// along-track (forward) axis: from depression_min to depression_max below the horizontal, and along_track
/// wide at every depression. The port fan is the mirror image of the starboard fan, ray by ray. Patterns are
/// about the axis at axis_depression_deg, or about the fan's middle.
class Sidescan : public Sensor {
 public:
  /// Throws std::invalid_argument for a fan, ranges or counts that make no sidescan, and for a sampling
  /// frequency: in_water() turns that into samples.
  explicit Sidescan(const SensorDescription& description);

 protected:
  Sidescan(const SensorDescription& description, const SidescanDescription& fan);
};

}  // namespace tubefoot
