// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "scene/description/sensor_section.hpp"

namespace tubefoot {

/// The documentation of one key, in the words of docs/scene-file.md. The reader and its messages use the
/// same text.
struct SceneKey {
  std::string section;        ///< "[water]", "[[terrain]]"; empty for keys before all sections
  std::string kind;           ///< e.g. `kind = "flat"` for a key of this kind only
  std::string name;           ///< e.g. "depth_m"
  std::string type;           ///< number, integer, 3 numbers, text, file, true or false
  std::string unit;           ///< in words, e.g. "metres"; empty if there is none
  std::string default_value;  ///< in TOML notation; "required" or "none"
  std::string range;          ///< e.g. "> 0, <= 170", or the permitted texts; empty if unrestricted
};

/// Returns every key that read_scene_file() knows, by section, with the keys of the kinds of sensors.
std::vector<SceneKey> scene_file_keys(const SensorSections& kinds);

}  // namespace tubefoot
