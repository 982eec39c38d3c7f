// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sensors/recordings/receiver_output.hpp"
#include "sensors/recordings/recording.hpp"
#include "sensors/recordings/run_context.hpp"
#include "sensors/recordings/writing_cost.hpp"

// The pictures of recordings that kinds of sensors share: PNG (for looking at, logarithmic) and EXR (32-bit
// float, for measuring, linear energy). docs/echo-file.md says how pixels are made. With `receiver_output`
// each PNG has one beside it of what the instrument shows, "-received" at the end of its name.
namespace tubefoot {

/// Of a fan of beams side by side, those that are asked for: <sensor>-sequence.png (pings picked from
/// several; sequence_frames), of several pings <sensor>-sequence.gif where that is wanted (animation_frames),
/// and of each ping <sensor>-<ping>.png in true fan geometry with a range and angle frame, and
/// <sensor>-<ping>.exr (beams x samples, unscaled). `otherwise`: what is asked for where nobody says. Returns
/// the files' names, relative to `folder`, which exists. Throws std::runtime_error naming the file and what
/// failed. A picture is written even without a font to label it with; `warnings` then says so.
std::vector<std::filesystem::path> write_fan_pictures(const std::filesystem::path& folder,
                                                      const Recording& recording,
                                                      const std::optional<ReceiverOutput>& receiver_output,
                                                      const PictureSettings& settings,
                                                      PictureSettings::Which otherwise,
                                                      std::vector<std::string>& warnings);

/// Of a beam to port and one to starboard: <sensor>.png waterfall, last ping on top, port left, and
/// <sensor>.exr. As write_fan_pictures() otherwise.
std::vector<std::filesystem::path> write_two_sided_pictures(
    const std::filesystem::path& folder, const Recording& recording,
    const std::optional<ReceiverOutput>& receiver_output, const PictureSettings& settings,
    std::vector<std::string>& warnings);

/// What these take, about.
WritingCost cost_of_fan_pictures(const Recording& recording, bool receiver_output,
                                 const PictureSettings& settings, PictureSettings::Which otherwise);
WritingCost cost_of_two_sided_pictures(const Recording& recording, bool receiver_output,
                                       const PictureSettings& settings);

/// The font that labels a sensor's pictures; empty, and `warnings` says so, where there is none.
const std::string& font_for(const std::string& sensor, std::vector<std::string>& warnings);

inline void append(std::vector<std::filesystem::path>& files,
                   const std::vector<std::filesystem::path>& more) {
  files.insert(files.end(), more.begin(), more.end());
}

}  // namespace tubefoot
