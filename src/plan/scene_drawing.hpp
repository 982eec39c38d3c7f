// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "run/placement.hpp"
#include "run/survey.hpp"

namespace tubefoot {

/// Returns a drawing (SVG) of a scene: plan and side views with axes in metres.
///
/// The views show seabed, objects, tracks with headings, and the sectors of the sensors at their first,
/// middle and last pings. If the scene is much larger than the surroundings of the first sensor, a plan and
/// a section show these surroundings. `placements`: placements of the objects, if known. No ping is
/// computed.
///
/// Throws InputError for a raster that can no longer be read, and Interrupted if the user stops the
/// program.
std::string scene_drawing(const Survey& survey, std::span<const SeabedPlacement> placements);

/// Name of the drawing in a result folder.
inline constexpr const char* scene_picture_name = "scene.png";

/// Writes the drawing as a PNG file. Throws as scene_drawing() does, and std::runtime_error, which names
/// the file.
void write_scene_picture(const std::filesystem::path& file, const Survey& survey,
                         std::span<const SeabedPlacement> placements);

/// Writes the drawing without given placements. They are computed if that is fast, otherwise omitted.
void write_scene_picture(const std::filesystem::path& file, const Survey& survey);

}  // namespace tubefoot
