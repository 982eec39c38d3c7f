// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sensors/recordings/receiver_output.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// Which pings of a recording its animation shows: all, or 200 of more, evenly spread, the first and the last
/// among them.
std::vector<std::size_t> animation_frames(std::size_t pings);

/// Writes a GIF that shows pings of an acoustic camera one after the other, over and over: fans of half the
/// size of draw_camera_frame()'s, on one scale of decibels, as fast as they were pinged, but 1 to 20 a
/// second. `font` and `receiver_output` as there. Throws std::runtime_error naming the file.
void write_camera_animation(const std::filesystem::path& file, const Recording& recording,
                            const std::string& font, const ReceiverOutput* receiver_output = nullptr);

}  // namespace tubefoot
