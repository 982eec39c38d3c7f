// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "run/placement.hpp"
#include "run/survey.hpp"

namespace tubefoot {

/// A scene as a drawing (SVG): plan and side views with axes in metres, seabed, objects, tracks with
/// headings, and where sensors look at their first, middle and last pings; a plan and a section near the
/// first sensor, where all of the scene is much larger. `placements`: of the objects, if they are known.
/// Computes no ping. Throws InputError for a raster that can no longer be read, Interrupted when somebody
/// wants to stop.
std::string scene_drawing(const Survey& survey, std::span<const SeabedPlacement> placements);

/// The name of that drawing in a result folder.
inline constexpr const char* scene_picture_name = "scene.png";

/// Writes the drawing as a PNG file. Throws as scene_drawing(), and std::runtime_error naming the file.
void write_scene_picture(const std::filesystem::path& file, const Survey& survey,
                         std::span<const SeabedPlacement> placements);

/// For who has not looked how objects stand: where that is soon known it is looked up, else left open.
void write_scene_picture(const std::filesystem::path& file, const Survey& survey);

}  // namespace tubefoot
