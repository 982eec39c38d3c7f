// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/odd_angles.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string_view>

namespace tubefoot {
namespace {

/// Returns whether a value is a multiple of 5 degrees in radians with at least four decimals. Values in
/// degrees rarely have so many decimals.
bool looks_like_radians(double value) {
  const std::string text = fmt::format("{}", value);
  const std::size_t point = text.find('.');
  if (point == std::string::npos || text.size() - point < 5 || std::abs(value) > 6.3) return false;
  const double degrees = std::abs(value) * 180 / std::numbers::pi, step = 5,
               off = std::abs(degrees - step * std::round(degrees / step));
  return degrees > step / 2 && off < 0.005;
}

struct Angle {
  std::string_view key;
  double value;
};

}  // namespace

std::vector<std::string> odd_angles(const SceneDescription& description) {
  std::vector<std::string> odd;
  const auto look = [&](const SourcePlace& place, const std::string& who,
                        std::initializer_list<Angle> angles) {
    for (const auto& [key, value] : angles)
      if (looks_like_radians(value))
        odd.push_back(fmt::format(
            "{}: '{}' of {} is {}, which looks like radians ({:.4g} degrees): give the angle in degrees",
            to_string(place), key, who, value, value * 180 / std::numbers::pi));
  };
  for (const ObjectDescription& o : description.objects)
    look(o.place, fmt::format("object '{}'", o.name),
         {{"heading_deg", o.heading_deg}, {"pitch_deg", o.pitch_deg}, {"roll_deg", o.roll_deg}});
  for (const TrajectoryDescription& t : description.trajectories) {
    const std::string who = fmt::format("trajectory '{}'", t.name);
    if (const auto* fixed = std::get_if<FixedTrajectory>(&t.kind))
      look(t.place, who,
           {{"heading_deg", fixed->heading_deg},
            {"pitch_deg", fixed->pitch_deg},
            {"roll_deg", fixed->roll_deg}});
    if (const auto* line = std::get_if<LineTrajectory>(&t.kind))
      look(t.place, who, {{"pitch_deg", line->pitch_deg}, {"roll_deg", line->roll_deg}});
  }
  for (const SensorDescription& s : description.sensors)
    look(s.place, fmt::format("sensor '{}'", s.name),
         {{"yaw_deg", s.yaw_deg}, {"tilt_deg", s.tilt_deg}, {"roll_deg", s.roll_deg}});
  return odd;
}

}  // namespace tubefoot
