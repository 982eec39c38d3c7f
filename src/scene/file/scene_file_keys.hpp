// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "scene/description/sensor_section.hpp"

namespace tubefoot {

/// The documentation of one key. The reader, its messages, `tubefoot keys` and docs/scene-keys.md use the
/// same text.
struct SceneKey {
  std::string section;        ///< "[water]", "[[terrain]]"; empty for keys before all sections
  std::string kind;           ///< e.g. `kind = "flat"` for a key of this kind only
  std::string name;           ///< e.g. "depth_m"
  std::string type;           ///< number, integer, 3 numbers, text, file, true or false
  std::string unit;           ///< in words, e.g. "metres"; empty if there is none
  std::string default_value;  ///< in TOML notation; "required" or "none"
  std::string range;          ///< e.g. "> 0, <= 170", or the permitted texts; empty if unrestricted
  std::string meaning;        ///< one or two sentences; names of keys are between back quotes
  std::string former_name;    ///< deprecated name that the reader accepts; empty if there is none
};

/// The documentation of a section, or of a kind within a section.
struct SceneSection {
  std::string section, kind;  ///< as in SceneKey
  std::string meaning;        ///< in the format of SceneKey::meaning
};

/// Returns all sections, each followed by its kinds. The first section stands for the keys before all
/// sections.
std::vector<SceneSection> scene_file_sections(const SensorSections& kinds);

/// Returns every key that read_scene_file() knows, by section, with the keys of the kinds of sensors.
std::vector<SceneKey> scene_file_keys(const SensorSections& kinds);

}  // namespace tubefoot
