// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "engine/water/water_column.hpp"
#include "kmall/kmall_survey.hpp"

// This header declares positions of the arrays of a Kongsberg sonar. It also declares the positions of
// soundings from travel times, angles, attitude and sound speeds.

namespace tubefoot {

/// Returns the rotation that turns axes of the array into axes of the vessel, both x forward, y to starboard,
/// z down.
glm::dmat3 rotation_of(double roll_deg, double pitch_deg, double heading_deg);
inline glm::dmat3 rotation_of(const KmallMounting& mounting) {
  return rotation_of(mounting.roll_deg, mounting.pitch_deg, mounting.heading_deg);
}
/// Returns the phase centre of a part of the transmitter, or of the receiver, in axes of the vessel.
glm::dvec3 arm_of(const KmallMounting& mounting, std::size_t sub_array = 1);

/// Returns the sound speeds with which the sonar places the soundings of a ping. The measured speed applies
/// down to the transducer. From there, the profile is linear to its points below. Depths are those of the
/// profile.
SoundSpeedProfile profile_at(const KmallSurvey& survey, double transducer_depth_m, double sound_speed_m_s);

/// Returns the depth of the transmitter of a ping below the water line.
double transducer_depth_m(const KmallSurvey& survey, const KmallPing& ping);

/// Returns the position of a sounding from the reference point. Axes: x along the heading of the ping, y to
/// starboard, z down. It lies on the cone of the transmit sector at the time of transmission. It also lies on
/// the cone of the receive beam at the time of reception (Beaudoin, Hughes Clarke and Bartlett 2004, with
/// separate apexes). The two-way travel time is the sum of the times of two rays. Empty if there is no
/// attitude at these times or no such point.
std::optional<glm::dvec3> recomputed(const KmallSurvey& survey, const KmallPing& ping,
                                     const KmallSounding& sounding, const WaterColumn& water);

/// Distances between the soundings of the file and the recomputed ones.
struct KmallResiduals {
  std::size_t soundings = 0;
  double median_m = 0, percentile_95_m = 0;
};
/// Largest number of pings that residuals_of() compares.
constexpr std::size_t most_checked_pings = 100;
/// Compares the valid soundings of pings that are spread over the line. 0 soundings if none can be
/// recomputed.
KmallResiduals residuals_of(const KmallSurvey& survey);

}  // namespace tubefoot
