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

// Pictures of recordings that several sensor kinds share: PNG (for viewing, logarithmic) and EXR (32-bit
// float, for measurements, linear energy). docs/output-files.md defines the pixels. With `receiver_output`
// each PNG has a second one of the instrument's display; its name ends with "-received".
namespace tubefoot {

/// Writes the requested pictures of a fan of adjacent beams:
/// - <sensor>-sequence.png for several pings (selected by sequence_frames),
/// - <sensor>-sequence.gif for several pings on request (animation_frames),
/// - <sensor>-<ping>.png of each ping in true fan geometry with a range and angle frame,
/// - <sensor>-<ping>.exr of each ping (beams x samples, unscaled).
/// `otherwise` applies if the settings request nothing. Returns the files' names, relative to `folder`,
/// which must exist. Throws std::runtime_error that names the file and the failed operation. Without a font
/// for labels the pictures are still written, and `warnings` says so. `omitted`: see RunContext.
std::vector<std::filesystem::path> write_fan_pictures(const std::filesystem::path& folder,
                                                      const Recording& recording,
                                                      const std::optional<ReceiverOutput>& receiver_output,
                                                      const PictureSettings& settings,
                                                      PictureSettings::Which otherwise,
                                                      std::vector<std::string>& warnings,
                                                      const OmittedProducts& omitted = {});

/// Writes the pictures of a beam to port and one to starboard: the waterfall <sensor>.png, last ping on top,
/// port left, and <sensor>.exr. Otherwise as write_fan_pictures().
std::vector<std::filesystem::path> write_two_sided_pictures(
    const std::filesystem::path& folder, const Recording& recording,
    const std::optional<ReceiverOutput>& receiver_output, const PictureSettings& settings,
    std::vector<std::string>& warnings, const OmittedProducts& omitted = {});

/// Names of these products (SensorKind::products()).
std::vector<std::string> fan_picture_products();
std::vector<std::string> two_sided_picture_products();

/// Approximate cost of these pictures.
WritingCost cost_of_fan_pictures(const Recording& recording, bool receiver_output,
                                 const PictureSettings& settings, PictureSettings::Which otherwise,
                                 const OmittedProducts& omitted = {});
WritingCost cost_of_two_sided_pictures(const Recording& recording, bool receiver_output,
                                       const PictureSettings& settings, const OmittedProducts& omitted = {});

/// The font for the labels of a sensor's pictures. It is empty if none exists, and `warnings` says so.
const std::string& font_for(const std::string& sensor, std::vector<std::string>& warnings);

inline void append(std::vector<std::filesystem::path>& files,
                   const std::vector<std::filesystem::path>& more) {
  files.insert(files.end(), more.begin(), more.end());
}

}  // namespace tubefoot
