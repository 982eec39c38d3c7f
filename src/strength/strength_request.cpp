// SPDX-License-Identifier: GPL-3.0-or-later
// Parses the arguments of the command `strength`: angles, frequencies and surfaces. strength_request.hpp
// describes their formats.
#include "strength/strength_request.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "files/number_list.hpp"
#include "files/usage_error.hpp"

namespace tubefoot {
namespace {

std::optional<double> frequency(std::string_view text) {
  for (const auto& [unit, factor] : {std::pair{"MHz", 1e6}, {"kHz", 1e3}, {"Hz", 1.0}}) {
    if (!text.ends_with(unit)) continue;
    const std::optional<double> value =
        number_of(text.substr(0, text.size() - std::string_view(unit).size()));
    return value && std::isfinite(*value * factor) ? std::optional(*value * factor) : std::nullopt;
  }
  return number_of(text);
}

}  // namespace

std::vector<double> angles_of(const std::string& text, const std::string& what) {
  return numbers_of(text, {what, "FIRST:LAST:STEP or numbers separated by commas, in degrees", 1.0});
}

std::vector<double> frequencies_of(const std::string& text) {
  const std::string expected =
      "FIRST:LAST:STEP or numbers separated by commas, in Hz, kHz or MHz: 38kHz,120kHz";
  std::vector<double> values = numbers_of(text, {"--frequencies", expected, std::nullopt, frequency});
  if (!(values.front() > 0))
    throw UsageError(
        fmt::format("--frequencies '{}': frequencies must be above 0; expected {}", text, expected));
  return values;
}

SmoothSurface surface_of(const std::string& text, double roughness_m) {
  SmoothSurface surface;
  surface.roughness_m = roughness_m;
  if (text == "rigid") return surface;
  surface.reflection = -1;
  if (text == "soft") return surface;
  const std::vector<std::string> parts = split_at(text, ':');
  if (parts[0] == "fluid" && (parts.size() == 3 || parts.size() == 4)) {
    const std::optional<double> density = number_of(parts[1]), speed = number_of(parts[2]),
                                loss = parts.size() == 4 ? number_of(parts[3]) : std::optional(0.0);
    if (density && speed && loss && *density > 0 && *speed > 0 && *loss >= 0) {
      surface.fluid = fluid_sediment(*density, *speed, *loss);
      return surface;
    }
  } else if (const std::optional<double> value = number_of(text); value && std::abs(*value) <= 1) {
    surface.reflection = *value;
    return surface;
  }
  throw UsageError(
      fmt::format("--reflection '{}': expected rigid, soft, a number from -1 to 1, or "
                  "fluid:DENSITY:SPEED[:LOSS] with ratios to the water and a loss in dB per wavelength",
                  text));
}

}  // namespace tubefoot
