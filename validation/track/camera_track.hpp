// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "sensors/recordings/recording.hpp"
#include "study/frame_motion.hpp"

namespace tubefoot {

/// Projection of camera frames onto a flat seabed.
struct SurfaceLayout {
  double seabed_m = 0;  ///< height of the seabed in the local frame
  double pixel_m = 0;   ///< side of a pixel on the seabed
};

/// Returns a frame of a camera as seen from above. Columns increase to starboard and rows forward from the
/// point below the camera, in the heading of the camera. `energies`: [beam][sample].
///
/// The mean of each range over the beams is removed, which leaves the brightness relative to the range.
/// Spreading, grazing angle and the elevation pattern of the beams are the same for all beams. Throws
/// std::invalid_argument for a camera that sees no seabed.
PixelMap ground_picture(const Recording& recording, std::size_t ping, std::span<const double> energies,
                        const SurfaceLayout& layout);

/// A step of a carrier between two frames, in the heading of the first one, in metres.
struct TrackStep {
  double starboard_m = 0, ahead_m = 0;
};

/// Returns the horizontal position of a place relative to a pose, to starboard and ahead in its heading.
TrackStep seen_from(const Pose& pose, glm::dvec3 place_m);
/// Returns the place on a flat seabed of height `seabed_m` at that relative position.
glm::dvec3 place_seen(const Pose& pose, TrackStep there, double seabed_m);

/// Track of a camera as estimated from its frames.
struct TrackEstimate {
  std::vector<TrackStep> measured, true_steps;  ///< from each frame to the next
  std::vector<FrameShift> shifts;
  /// Largest distance of a measured step from the true one, in pixels.
  double worst_pixels = 0;
  double least_correlation = 0, largest_correlation = 0;  ///< of consecutive frames, at their shifts
};

/// Estimates the track of a camera from its frames (find_shift() of neighbours). `frames`: one per ping.
TrackEstimate estimate_track(const Recording& recording, const std::vector<std::vector<double>>& frames,
                             const SurfaceLayout& layout, int most_shift);

}  // namespace tubefoot
