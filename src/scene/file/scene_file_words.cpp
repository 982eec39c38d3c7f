// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/file/scene_file_words.hpp"

#include <array>
#include <utility>

namespace tubefoot {
namespace {

/// Units in scene files, and others that a person may try. Longer endings precede endings that they
/// contain.
constexpr std::array<std::pair<std::string_view, std::string_view>, 36> units{{
    {"per_m3", "1/m^3"},
    {"db_per_km", "dB/km"},
    {"deg_per_hour", "degrees per hour"},
    {"m_per_hour", "metres per hour"},
    {"db_per_m", "dB/m"},
    {"np_per_m", "nepers per metre"},
    {"km_h", "km/h"},
    {"m_s", "m/s"},
    {"deg", "degrees"},
    {"degrees", "degrees"},
    {"rad", "radians"},
    {"mrad", "milliradians"},
    {"khz", "kHz"},
    {"hz", "Hz"},
    {"mhz", "MHz"},
    {"metres", "metres"},
    {"meters", "metres"},
    {"m", "metres"},
    {"km", "kilometres"},
    {"cm", "centimetres"},
    {"mm", "millimetres"},
    {"ft", "feet"},
    {"nmi", "nautical miles"},
    {"kn", "knots"},
    {"per_s", "1/s"},
    {"s", "seconds"},
    {"ms", "milliseconds"},
    {"us", "microseconds"},
    {"c", "degrees Celsius"},
    {"k", "kelvin"},
    {"f", "degrees Fahrenheit"},
    {"psu", "psu"},
    {"ppt", "parts per thousand"},
    {"db", "dB"},
    {"pct", "per cent"},
    {"cm4", "cm^4"},
}};

}  // namespace

MeasuredName measured_name(std::string_view key) {
  for (const auto& [ending, words] : units) {
    if (key.size() > ending.size() + 1 && key.ends_with(ending) &&
        key[key.size() - ending.size() - 1] == '_') {
      return {key.substr(0, key.size() - ending.size() - 1), words};
    }
  }
  return {key, {}};
}

}  // namespace tubefoot
