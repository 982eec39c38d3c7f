// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>
#include <vector>

#include "app/commands.hpp"
#include "files/usage_error.hpp"
#include "files/words.hpp"
#include "run/console/say.hpp"
#include "scene/file/sensor_presets.hpp"

namespace tubefoot {
namespace {

void print_line(const SensorPreset& preset) {
  tell("{:<26} {}\n{:<26} source: {}\n", preset.name, preset.title(), "", preset.source());
}

bool contains_ignoring_case(std::string_view text, std::string_view part) {
  const auto lower = [](unsigned char c) { return std::tolower(c); };
  return !std::ranges::search(text, part, {}, lower, lower).empty();
}

}  // namespace

int presets_command(const PresetsOptions& options) {
  if (!options.name) {
    for (const SensorPreset& preset : sensor_presets()) print_line(preset);
    return 0;
  }
  for (const SensorPreset& preset : sensor_presets())
    if (preset.name == *options.name) {
      tell("{}", preset.text);
      return 0;
    }
  // The argument is not the name of a preset: print all presets whose name or title contains it.
  bool any = false;
  for (const SensorPreset& preset : sensor_presets())
    if (contains_ignoring_case(fmt::format("{} {}", preset.name, preset.title()), *options.name)) {
      print_line(preset);
      any = true;
    }
  if (any) return 0;
  std::vector<std::string> names;
  for (const SensorPreset& preset : sensor_presets()) names.emplace_back(preset.name);
  const std::string_view meant = nearest(*options.name, names);
  throw UsageError(fmt::format("no preset matches '{}': {}'tubefoot presets' lists all", *options.name,
                               meant.empty() ? std::string() : fmt::format("did you mean '{}'? ", meant)));
}

}  // namespace tubefoot
