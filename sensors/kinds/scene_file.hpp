// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/description/scene_description.hpp"
#include "scene/file/scene_file_keys.hpp"
#include "sensors/recordings/sensor_kind.hpp"

// Reads scene files with all sensor kinds.
namespace tubefoot {

inline SceneDescription read_scene_file(const std::filesystem::path& file, bool confined = false) {
  return read_scene_file(file, sensor_kinds(), confined);
}

inline SceneDescription read_scene_text(const std::string& text, const std::filesystem::path& file,
                                        bool confined = false) {
  return read_scene_text(text, file, sensor_kinds(), confined);
}

inline std::vector<SceneKey> scene_file_keys() { return scene_file_keys(sensor_kinds()); }

inline std::vector<SceneSection> scene_file_sections() { return scene_file_sections(sensor_kinds()); }

}  // namespace tubefoot
