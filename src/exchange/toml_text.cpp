// SPDX-License-Identifier: GPL-3.0-or-later
#include "exchange/toml_text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "sensors/recordings/pose_angles.hpp"

namespace tubefoot {
namespace {

/// Rounds to twelve decimals of a degree. Numbers that people wrote are restored, and the error is below a
/// picometre in 50 m.
double rounded_deg(double degrees) { return std::round(degrees * 1e12) / 1e12 + 0.0; }

}  // namespace

std::string toml_quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < ' ' || c == 127)
      out += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    else
      out += c;
  }
  return out + '"';
}

std::string toml_list(const std::vector<std::string>& numbers) {
  constexpr std::size_t per_line = 8;
  std::string text = "[";
  for (std::size_t k = 0; k < numbers.size(); ++k)
    text += fmt::format("{}{}", k == 0 ? "" : k % per_line == 0 ? ",\n  " : ", ", numbers[k]);
  return text + "]";
}

std::string toml_list(const std::vector<double>& numbers) {
  std::vector<std::string> texts;
  for (const double number : numbers) texts.push_back(fmt::format("{}", number));
  return toml_list(texts);
}

std::string place_keys(const Placement& placed) {
  const PoseAngles angles = angles_of(glm::quat_cast(placed.turn));
  std::string text = fmt::format("position_m = [{}, {}, {}]\n", placed.position_m.x, placed.position_m.y,
                                 placed.position_m.z);
  for (const auto& [key, value] :
       {std::pair("heading_deg", angles.heading_deg), std::pair("pitch_deg", angles.pitch_deg),
        std::pair("roll_deg", angles.roll_deg)})
    if (rounded_deg(value) != 0) text += fmt::format("{} = {}\n", key, rounded_deg(value));
  return text;
}

}  // namespace tubefoot
