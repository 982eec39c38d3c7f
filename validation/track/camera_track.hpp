// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "sensors/recordings/recording.hpp"
#include "study/frame_motion.hpp"

namespace tubefoot {

/// How camera frames are laid out on a flat seabed.
struct SurfaceLayout {
  double seabed_m = 0;  ///< height of the seabed in the local frame
  double pixel_m = 0;   ///< side of a pixel on the seabed
};

/// A camera's frame as seen from above: columns to starboard, rows ahead of the point below the camera, in
/// the camera's own heading. `energies`: [beam][sample]. Each range's mean over the beams is taken out, which
/// leaves how much brighter or darker than its range a place is: spreading, grazing angle and the beams'
/// elevation pattern are the same for all beams. Throws std::invalid_argument for a camera that sees no
/// seabed.
PixelMap ground_picture(const Recording& recording, std::size_t ping, std::span<const double> energies,
                        const SurfaceLayout& layout);

/// A step of a carrier between two frames, in the first one's heading, metres.
struct TrackStep {
  double starboard_m = 0, ahead_m = 0;
};

/// Where a place lies for somebody at a pose: to starboard and ahead in its heading, level.
TrackStep seen_from(const Pose& pose, glm::dvec3 place_m);
/// The place on a flat seabed of height `seabed_m` that lies there.
glm::dvec3 place_seen(const Pose& pose, TrackStep there, double seabed_m);

/// What frames tell of the way between them.
struct TrackEstimate {
  std::vector<TrackStep> measured, true_steps;  ///< from each frame to the next
  std::vector<FrameShift> shifts;
  /// Largest distance of a measured step from the true one, in pixels.
  double worst_pixels = 0;
  double least_correlation = 0, largest_correlation = 0;  ///< of neighbouring frames, at their shifts
};

/// Estimates the way of a camera from its frames (find_shift() of neighbours). `frames`: one a ping.
TrackEstimate estimate_track(const Recording& recording, const std::vector<std::vector<double>>& frames,
                             const SurfaceLayout& layout, int most_shift);

}  // namespace tubefoot
