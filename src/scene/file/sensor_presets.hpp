// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tubefoot {

/// An existing sonar as the keys of a [[sensors]] section: a file of scenes/presets that is embedded in the
/// program. The first line of its comment names the sonar. The rest of the comment names the source of the
/// figures ("source: ").
struct SensorPreset {
  std::string_view name;  ///< name of the file without ".toml"
  std::string_view text;  ///< TOML text with its comments

  std::string title() const;
  std::string source() const;
};

/// Returns all presets, sorted by name.
std::span<const SensorPreset> sensor_presets();
std::vector<std::string> sensor_preset_names();

}  // namespace tubefoot
