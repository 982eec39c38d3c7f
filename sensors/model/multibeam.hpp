// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/model/sensor.hpp"

namespace tubefoot {

/// Multibeam echosounder with ideal rectangular beams: a fan across the track, turned about the along-track
/// (forward) axis. Beam 0 is the port-most; of an odd number of beams the middle one looks straight down.
/// Each beam is a sector of beam_across_deg by along_track_deg, along_track_deg at every angle.
class Multibeam : public Sensor {
 public:
  /// Throws std::invalid_argument for a fan, ranges or counts that make no multibeam.
  explicit Multibeam(const SensorDescription& description);
};

/// With a receive pattern the transmission opens so far beyond the outermost beams, either side: three widths
/// of those, as they are steered (beam_across_deg / cosine), up to 1 degree short of the horizontal. 0 for
/// ideal beams, which hear nothing from there.
double lit_beyond_rad(const SensorDescription& description);

/// Angle of a multibeam's beam from straight down of the sensor, starboard positive.
double across_angle_rad(const BeamAxis& axis);
/// Direction of a beam at such an angle, in the sensor's frame.
glm::dvec3 across_direction(double across_angle_rad);

}  // namespace tubefoot
