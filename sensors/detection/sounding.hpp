// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "sensors/detection/bottom_detection.hpp"

namespace tubefoot {

/// A place of the seabed that a beam found.
struct Sounding {
  std::uint32_t ping = 0, beam = 0;  ///< counted from 0
  double time_s = 0;                 ///< of the transmission, on the scene's clock
  glm::dvec3 position_m{0};          ///< east, north, up in the local frame
  double two_way_travel_time_s = 0;
  double slant_range_m = 0;
  double beam_angle_deg = 0;  ///< of the beam's axis from straight down of the sensor, starboard positive
  double amplitude = 0;       ///< of the sample that was picked, as the time series has it
  double quality = 0;         ///< 0 to 1, of the detector
  DetectionMethod method = DetectionMethod::maximum;
  DetectionFlags flags;  ///< what makes it doubtful
};

}  // namespace tubefoot
