// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/model/multibeam.hpp"

#include <algorithm>
#include <numeric>

#include "sensors/model/angles.hpp"

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

double lit_beyond_rad(const SensorDescription& description) {
  const auto& fan = std::get<MultibeamDescription>(description.kind);
  if (description.receive.pattern == "none") return 0;
  const double outermost_rad = fan.beams > 1 ? radians(fan.swath_deg) / 2 : 0,
               edge_rad = outermost_rad + radians(fan.beam_across_deg) / 2;
  constexpr double widths = 3, grazing_deg = 1;
  const double wanted_rad = widths * radians(fan.beam_across_deg) / std::cos(outermost_rad);
  return std::max(0.0, std::min(wanted_rad, radians(90 - grazing_deg) - edge_rad));
}

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
  const auto cut = [&](double from, double to, int parts) {
    const std::vector<double> edges = even_edges(from, to, parts);
    std::vector<double>& all = shot.sectors.back().azimuth_edges_rad;
    all.insert(all.end(), edges.begin() + (all.empty() ? 0 : 1), edges.end());
  };
  const auto name = [&](std::uint32_t beam, int parts) {
    shot.beam_of_tube.insert(shot.beam_of_tube.end(), static_cast<std::size_t>(parts), beam);
  };
  const bool hears_all = description.receive.pattern != "none";
  const double from = angles.front() - half_across_rad, to = angles.back() + half_across_rad;
  const double margin_rad = lit_beyond_rad(description);
  const int beyond = margin_rad > 0 ? slices_for(margin_rad, description.cone_tolerance) : 0;
  const auto last = static_cast<std::uint32_t>(angles.size() - 1);
  if (hears_all || side_by_side(fan)) shot.sectors.push_back({{}, along_rad, frame});
  if (beyond > 0) {
    cut(from - margin_rad, from, beyond);
    name(0, beyond);
  }
  if (side_by_side(fan)) {
    cut(from, to, fan.beams * slices);
    for (std::uint32_t beam = 0; beam <= last; ++beam) name(beam, slices);
  } else if (hears_all) {
    // No beam has a tube of its own, and none is to be heard twice where beams overlap: the fan is cut midway
    // between them.
    for (std::uint32_t beam = 0; beam <= last; ++beam) {
      const double begin = beam == 0 ? from : (angles[beam - 1] + angles[beam]) / 2,
                   end = beam == last ? to : (angles[beam] + angles[beam + 1]) / 2;
      cut(begin, end, slices_for(end - begin, description.cone_tolerance));
      name(beam, slices_for(end - begin, description.cone_tolerance));
    }
  } else {
    for (std::uint32_t beam = 0; beam <= last; ++beam) {
      const double angle = angles[beam];
      shot.sectors.push_back(
          {even_edges(angle - half_across_rad, angle + half_across_rad, slices), along_rad, frame});
      name(beam, slices);
    }
  }
  if (beyond > 0) {
    cut(to, to + margin_rad, beyond);
    name(last, beyond);
  }
  shot.beams.resize(angles.size());
  std::iota(shot.beams.begin(), shot.beams.end(), 0u);
  shot.fans.push_back({0, static_cast<std::uint32_t>(angles.size()),
                       static_cast<std::uint32_t>(shot.beam_of_tube.size()), -up_axis, forward_axis,
                       starboard_axis});
  shots_.push_back(std::move(shot));
}

}  // namespace tubefoot
