// SPDX-License-Identifier: GPL-3.0-or-later
#include "exchange/sonar_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "exchange/plain_number.hpp"
#include "exchange/toml_text.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/model/sensor.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

using Shape = ExchangedSonar::Shape;

/// Returns the angle of a beam in the plane of the fan, from the centre to starboard.
double angle_in_fan_deg(const BeamAxis& beam, bool looks_down) {
  const double level = std::cos(beam.elevation_rad);
  const glm::dvec3 axis(level * std::sin(beam.azimuth_rad), level * std::cos(beam.azimuth_rad),
                        std::sin(beam.elevation_rad));
  return degrees(looks_down ? std::atan2(axis.x, -axis.z) : std::atan2(axis.x, axis.y));
}

}  // namespace

ExchangedSonar sonar_words(const Sensor& sensor) {
  const SensorDescription& description = sensor.description();
  const SensorKind& kind = kind_of(description);
  std::optional<SonarOutline> outline = kind.outline(description);
  if (!outline)
    throw InputError(description.place, fmt::format("sensor '{}': a sonar of kind '{}' cannot be exported to "
                                                    "other engines: choose another sensor with --sensor",
                                                    description.name, kind.name()));
  ExchangedSonar sonar;
  static_cast<SonarOutline&>(sonar) = std::move(*outline);
  sonar.name = description.name;
  if (sonar.kind.empty()) sonar.kind = kind.name();
  if (description.cone_tolerance != SensorDescription().cone_tolerance)
    sonar.keys.emplace_back("cone_tolerance", fmt::format("{}", description.cone_tolerance));
  sonar.frequency_khz = sensor.frequency_khz();
  const RangeSamples& samples = sensor.samples();
  sonar.samples = samples.count;
  sonar.range_min_m = samples.first_m;
  sonar.range_max_m = plain(samples.first_m + samples.step_m * samples.count);
  constexpr double right_angle_deg = 90;
  for (const BeamAxis& beam : sensor.beams())
    sonar.azimuth_deg.push_back(plain(angle_in_fan_deg(beam, sonar.looks_down), right_angle_deg));
  if (sonar.shape == Shape::turning) {
    sonar.horizontal_deg = plain(degrees(sensor.beams().front().azimuth_width_rad));
  } else if (sonar.shape == Shape::fan) {
    const auto width = [&](const BeamAxis& beam) {
      return degrees(sonar.looks_down ? beam.elevation_width_rad : beam.azimuth_width_rad);
    };
    sonar.horizontal_deg = plain(sonar.azimuth_deg.back() - sonar.azimuth_deg.front() +
                                 (width(sensor.beams().front()) + width(sensor.beams().back())) / 2);
  }
  return sonar;
}

bool is_key(std::string_view text) {
  return !text.empty() && text.size() <= 40 &&
         std::ranges::all_of(text, [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; });
}

std::string toml_value(std::string_view text) {
  constexpr std::size_t longest = 200'000;
  if (text.size() > longest) return {};
  if (is_key(text) && text != "inf" && text != "nan") return fmt::format("\"{}\"", text);
  std::vector<std::string> numbers;
  while (!text.empty()) {
    const std::size_t space = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, space);
    text.remove_prefix(std::min(space + 1, text.size()));
    if (word.empty()) continue;
    std::int64_t whole = 0;
    double number = 0;
    const char* end = word.data() + word.size();
    if (const auto read = std::from_chars(word.data(), end, whole); read.ec == std::errc() && read.ptr == end)
      numbers.push_back(fmt::format("{}", whole));
    else if (const auto real = std::from_chars(word.data(), end, number);
             real.ec == std::errc() && real.ptr == end && std::isfinite(number))
      numbers.push_back(fmt::format("{}", number));
    else
      return {};
  }
  if (numbers.empty()) return {};
  return numbers.size() == 1 ? numbers.front() : toml_list(numbers);
}

}  // namespace tubefoot
