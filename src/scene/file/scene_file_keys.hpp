// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace tubefoot {

/// What docs/scene-file.md says about one key, in the same words; the reader and its messages use it too.
struct SceneKey {
  std::string section;        ///< "[water]", "[[terrain]]"; empty for keys above all sections
  std::string kind;           ///< e.g. `kind = "flat"` for a key that only this kind has
  std::string name;           ///< e.g. "depth_m"
  std::string type;           ///< number, integer, 3 numbers, text, file, true or false
  std::string unit;           ///< in words, e.g. "metres"; empty for none
  std::string default_value;  ///< as written in TOML; "required" or "none"
  std::string range;          ///< e.g. "> 0, <= 170", or the texts to choose from; empty for any
};

/// Every key that read_scene_file knows, section by section.
std::vector<SceneKey> scene_file_keys();

}  // namespace tubefoot
