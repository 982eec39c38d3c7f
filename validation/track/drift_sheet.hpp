// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "sensors/pictures/canvas.hpp"
#include "track/camera_track.hpp"

namespace tubefoot {

/// Draws the first eight frames of a camera as seen from above (ground_picture), each cut to the same
/// square ahead of the camera. The viewing direction of the camera is upwards.
///
/// A ring follows one place of the seabed by the true track, and dots mark its positions in earlier frames.
/// The place is the brightest one near the centre of the first square, so that the viewer can check whether
/// the texture moves with it. `font` as for Canvas. Throws std::invalid_argument for fewer frames, or if
/// the seabed ahead is not visible.
Canvas draw_drift(const Recording& recording, const std::vector<std::vector<double>>& frames, double seabed_m,
                  const std::string& font);

}  // namespace tubefoot
