// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/file/sensor_presets.hpp"

namespace tubefoot {
namespace {

/// Returns the lines of the leading comment of a text, without comment marks.
std::vector<std::string> head_of(std::string_view text) {
  std::vector<std::string> lines;
  while (text.starts_with("# ")) {
    const std::size_t end = text.find('\n');
    lines.emplace_back(text.substr(2, end - 2));
    text.remove_prefix(end + 1);
  }
  return lines;
}

}  // namespace

std::string SensorPreset::title() const { return head_of(text).front(); }

std::string SensorPreset::source() const {
  constexpr std::string_view mark = "source: ";
  std::string joined;
  const std::vector<std::string> lines = head_of(text);
  for (std::size_t i = 1; i < lines.size(); ++i) joined += (i > 1 ? " " : "") + lines[i];
  return joined.starts_with(mark) ? joined.substr(mark.size()) : joined;
}

std::vector<std::string> sensor_preset_names() {
  std::vector<std::string> names;
  for (const SensorPreset& preset : sensor_presets()) names.emplace_back(preset.name);
  return names;
}

}  // namespace tubefoot
