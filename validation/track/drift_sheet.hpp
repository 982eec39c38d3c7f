// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "sensors/pictures/canvas.hpp"
#include "track/camera_track.hpp"

namespace tubefoot {

/// Draws the first eight frames of a camera as seen from above, flattened (ground_picture), cut to the same
/// square ahead of the camera, the way it looks up. A ring follows one place of the seabed by the camera's
/// true way; dots are where it was in the frames before. The place is the brightest near the middle of the
/// first square, so that the eye can tell whether what is there goes along. `font` as for Canvas. Throws
/// std::invalid_argument for fewer frames, and where the seabed ahead is not seen.
Canvas draw_drift(const Recording& recording, const std::vector<std::vector<double>>& frames, double seabed_m,
                  const std::string& font);

}  // namespace tubefoot
