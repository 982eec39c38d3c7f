// SPDX-License-Identifier: GPL-3.0-or-later
// Parses the arguments of the command `strength`: angles, frequencies and surfaces. strength_request.hpp
// describes their formats.
#include "strength/strength_request.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <functional>
#include <optional>

#include "files/usage_error.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t most_values = 1000000;

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == at)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

std::optional<double> number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<double> frequency(std::string_view text) {
  for (const auto& [unit, factor] : {std::pair{"MHz", 1e6}, {"kHz", 1e3}, {"Hz", 1.0}}) {
    if (!text.ends_with(unit)) continue;
    const std::optional<double> value = number(text.substr(0, text.size() - std::string_view(unit).size()));
    return value && std::isfinite(*value * factor) ? std::optional(*value * factor) : std::nullopt;
  }
  return number(text);
}

std::vector<double> values_of(const std::string& text, const std::string& what, const std::string& expected,
                              std::optional<double> step,
                              const std::function<std::optional<double>(std::string_view)>& read) {
  const auto fail = [&](const std::string& why) {
    throw UsageError(fmt::format("{} '{}': {}; expected {}", what, text, why, expected));
  };
  const auto value = [&](const std::string& word) {
    const std::optional<double> result = read(word);
    if (!result) fail(fmt::format("'{}' is not a number", word));
    return *result;
  };
  std::vector<double> values;
  const std::vector<std::string> range = split(text, ':');
  if (range.size() == 1) {
    for (const std::string& word : split(text, ',')) values.push_back(value(word));
  } else {
    if (range.size() > 3 || (range.size() == 2 && !step)) fail("the step is missing");
    const double first = value(range[0]), last = value(range[1]);
    const double by = range.size() == 3 ? value(range[2]) : *step;
    if (!(by > 0)) fail("the step is not above 0");
    if (last < first) fail("the last value is less than the first");
    const double count = std::floor((last - first) / by * (1 + 1e-12) + 1e-9) + 1;
    if (!(count <= static_cast<double>(most_values)))
      fail(fmt::format("the range has more than {} values", most_values));
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
      values.push_back(first + static_cast<double>(k) * by);
  }
  for (std::size_t k = 1; k < values.size(); ++k)
    if (!(values[k] > values[k - 1])) fail("the values do not increase");
  return values;
}

}  // namespace

std::vector<double> angles_of(const std::string& text, const std::string& what) {
  return values_of(text, what, "FIRST:LAST:STEP or numbers separated by commas, in degrees", 1.0, number);
}

std::vector<double> frequencies_of(const std::string& text) {
  const std::string expected =
      "FIRST:LAST:STEP or numbers separated by commas, in Hz, kHz or MHz: 38kHz,120kHz";
  std::vector<double> values = values_of(text, "--frequencies", expected, std::nullopt, frequency);
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
  const std::vector<std::string> parts = split(text, ':');
  if (parts[0] == "fluid" && (parts.size() == 3 || parts.size() == 4)) {
    const std::optional<double> density = number(parts[1]), speed = number(parts[2]),
                                loss = parts.size() == 4 ? number(parts[3]) : std::optional(0.0);
    if (density && speed && loss && *density > 0 && *speed > 0 && *loss >= 0) {
      surface.fluid = fluid_sediment(*density, *speed, *loss);
      return surface;
    }
  } else if (const std::optional<double> value = number(text); value && std::abs(*value) <= 1) {
    surface.reflection = *value;
    return surface;
  }
  throw UsageError(
      fmt::format("--reflection '{}': expected rigid, soft, a number from -1 to 1, or "
                  "fluid:DENSITY:SPEED[:LOSS] with ratios to the water and a loss in dB per wavelength",
                  text));
}

}  // namespace tubefoot
