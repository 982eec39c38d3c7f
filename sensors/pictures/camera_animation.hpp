// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sensors/recordings/receiver_output.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// Selects the pings of a recording that its animation shows: all, or 200 uniformly spaced ones, including
/// the first and the last.
std::vector<std::size_t> animation_frames(std::size_t pings);

/// Writes a GIF that shows pings of an acoustic camera in a loop. Its fans have half the size of those of
/// draw_camera_frame(), and one decibel scale. The frame rate is that of the pings, limited to 1 to 20 per
/// second. `font` and `receiver_output` have the same meaning as there. Throws std::runtime_error with the
/// file's name.
void write_camera_animation(const std::filesystem::path& file, const Recording& recording,
                            const std::string& font, const ReceiverOutput* receiver_output = nullptr);

}  // namespace tubefoot
