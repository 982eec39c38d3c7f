// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/multibeam.hpp"

#include <numeric>

#include "sensors/angles.hpp"

namespace tubefoot {
namespace {

constexpr double straight_down_rad = std::numbers::pi / 2;

/// Angles of the beams' axes from straight down.
std::vector<double> across_angles_rad(const MultibeamDescription& fan) {
  if (fan.beams == 1) return {0};
  const double outermost_rad = radians(fan.swath_deg) / 2;
  std::vector<double> angles;
  for (int beam = 0; beam < fan.beams; ++beam) {
    // An integer over an integer: exactly 0 in the middle and -1 and 1 at the ends.
    const double place = static_cast<double>(2 * beam - (fan.beams - 1)) / (fan.beams - 1);
    angles.push_back(fan.spacing == "distance" ? std::atan(place * std::tan(outermost_rad))
                                               : place * outermost_rad);
  }
  return angles;
}

/// Whether each beam begins where the one before it ends: neighbours then share their rays.
bool side_by_side(const MultibeamDescription& fan) {
  if (fan.beams == 1) return true;
  const double step_deg = fan.swath_deg / (fan.beams - 1);
  return fan.spacing == "angle" && std::abs(step_deg - fan.beam_across_deg) < 1e-9 * fan.beam_across_deg;
}

}  // namespace

double across_angle_rad(const BeamAxis& axis) {
  return std::copysign(straight_down_rad + axis.elevation_rad, axis.azimuth_rad);
}

glm::dvec3 across_direction(double across_angle_rad) {
  return std::sin(across_angle_rad) * starboard_axis - std::cos(across_angle_rad) * up_axis;
}

Multibeam::Multibeam(const SensorDescription& description) : Sensor(description) {
  const auto& fan = std::get<MultibeamDescription>(description.kind);
  require(fan.beams >= 1, description, "beams", fan.beams, "1 or more");
  require(fan.samples >= 1, description, "samples", fan.samples, "1 or more");
  require(fan.swath_deg > 0 && fan.swath_deg < 180, description, "swath_deg", fan.swath_deg,
          "above 0 and below 180");
  require(fan.beam_across_deg > 0 && (fan.beams > 1 ? fan.swath_deg : 0) + fan.beam_across_deg <= 180,
          description, "beam_across_deg", fan.beam_across_deg,
          "above 0, and no beam may reach above the horizontal");
  require(fan.along_track_deg > 0 && fan.along_track_deg < 180, description, "along_track_deg",
          fan.along_track_deg, "above 0 and below 180");
  require(fan.range_min_m >= 0, description, "range_min_m", fan.range_min_m, "0 or more");
  require(fan.range_max_m > fan.range_min_m, description, "range_max_m", fan.range_max_m,
          "above range_min_m");

  frequency_khz_ = fan.frequency_khz;
  samples_ = {fan.range_min_m, (fan.range_max_m - fan.range_min_m) / fan.samples, fan.samples};

  const std::vector<double> angles = across_angles_rad(fan);
  const double half_across_rad = radians(fan.beam_across_deg) / 2,
               half_along_rad = radians(fan.along_track_deg) / 2;
  for (const double angle : angles)
    beams_.push_back({std::copysign(radians(90), angle), std::abs(angle) - straight_down_rad,
                      2 * half_along_rad, 2 * half_across_rad});

  // The grid's azimuth is the angle from straight down to starboard, its elevation that towards ahead.
  const glm::dmat3 frame(-up_axis, starboard_axis, forward_axis);
  const int slices = slices_for(2 * half_across_rad, description.cone_tolerance);
  const double corner_rad =
      height_of_corners(half_along_rad, 2 * half_across_rad / slices, description.cone_tolerance);
  const std::vector<double> along_rad{-corner_rad, corner_rad};
  Shot shot;
  if (side_by_side(fan)) {
    shot.sectors.push_back(
        {even_edges(angles.front() - half_across_rad, angles.back() + half_across_rad, fan.beams * slices),
         along_rad, frame});
  } else {
    for (const double angle : angles)
      shot.sectors.push_back(
          {even_edges(angle - half_across_rad, angle + half_across_rad, slices), along_rad, frame});
  }
  for (std::uint32_t beam = 0; beam < angles.size(); ++beam)
    shot.beam_of_tube.insert(shot.beam_of_tube.end(), static_cast<std::size_t>(slices), beam);
  shot.beams.resize(angles.size());
  std::iota(shot.beams.begin(), shot.beams.end(), 0u);
  shot.fans.push_back({0, static_cast<std::uint32_t>(angles.size()),
                       static_cast<std::uint32_t>(shot.beam_of_tube.size()), -up_axis, forward_axis,
                       starboard_axis});
  shots_.push_back(std::move(shot));
}

}  // namespace tubefoot
