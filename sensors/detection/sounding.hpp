// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "sensors/detection/bottom_detection.hpp"

namespace tubefoot {

/// A point of the seabed that a beam detected.
struct Sounding {
  std::uint32_t ping = 0, beam = 0;  ///< counted from 0
  std::uint32_t sector = 0;          ///< transmit sector of the beam, counted from 0
  double time_s = 0;                 ///< time of the transmission, on the scene's clock
  glm::dvec3 position_m{0};          ///< east, north, up in the local frame
  double two_way_travel_time_s = 0;
  double slant_range_m = 0;
  double beam_angle_deg = 0;  ///< angle of the beam's axis from the sensor's downward axis, positive to
                              ///< starboard
  double amplitude = 0;       ///< amplitude of the selected sample, in the units of the time series
  double quality = 0;         ///< of the detector, 0 to 1
  DetectionMethod method = DetectionMethod::maximum;
  DetectionFlags flags;  ///< reasons to doubt the sounding
};

inline bool is_cut(const Sounding& sounding) { return sounding.flags.has(DetectionFlag::cut_by_window); }

}  // namespace tubefoot
