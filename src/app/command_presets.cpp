// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "app/commands.hpp"
#include "files/usage_error.hpp"
#include "run/console/say.hpp"
#include "scene/file/sensor_presets.hpp"

namespace tubefoot {

int presets_command(const PresetsOptions& options) {
  if (!options.name) {
    for (const SensorPreset& preset : sensor_presets())
      tell("{:<26} {}\n{:<26} source: {}\n", preset.name, preset.title(), "", preset.source());
    return 0;
  }
  for (const SensorPreset& preset : sensor_presets())
    if (preset.name == *options.name) {
      tell("{}", preset.text);
      return 0;
    }
  throw UsageError(fmt::format("there is no preset '{}': 'tubefoot presets' lists them", *options.name));
}

}  // namespace tubefoot
