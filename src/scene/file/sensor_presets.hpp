// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tubefoot {

/// A sonar that exists, as the keys of a [[sensors]] section that say so: a file of scenes/presets, which the
/// program carries with it. Its first comment says which sonar that is, the rest of the comment where the
/// figures come from ("source: ").
struct SensorPreset {
  std::string_view name;  ///< of the file, without ".toml"
  std::string_view text;  ///< TOML, with its comments

  std::string title() const;
  std::string source() const;
};

/// All of them, by name.
std::span<const SensorPreset> sensor_presets();
std::vector<std::string> sensor_preset_names();

}  // namespace tubefoot
