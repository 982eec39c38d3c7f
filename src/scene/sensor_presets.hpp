// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tubefoot {

/// A sonar that exists, as the keys of a [[sensors]] section that say so.
struct SensorPreset {
  std::string_view name, title;
  std::string_view source;  ///< where its figures come from
  std::string_view keys;    ///< TOML
};

/// All of them, each sensor kind's together.
const std::vector<SensorPreset>& sensor_presets();
std::vector<std::string> sensor_preset_names();

}  // namespace tubefoot
