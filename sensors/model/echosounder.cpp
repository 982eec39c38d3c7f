// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/model/echosounder.hpp"

#include <algorithm>

#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

SensorDescription with_beam(SensorDescription description) {
  const auto& sounder = std::get<EchosounderDescription>(description.kind);
  for (PatternDescription* pattern : {&description.transmit, &description.receive})
    if (pattern->pattern == "none") {
      pattern->pattern = "gaussian";
      pattern->angle = "off_axis";
      pattern->width_deg = sounder.beam_deg;
    }
  return description;
}

}  // namespace

Echosounder::Echosounder(const SensorDescription& description) : Sensor(with_beam(description)) {
  const auto& sounder = std::get<EchosounderDescription>(description.kind);
  constexpr double widest_deg = 170;
  const double sector_deg = sounder.sector_deg.value_or(std::min(3 * sounder.beam_deg, widest_deg));
  require(sounder.samples >= 1, description, "samples", sounder.samples, "1 or more");
  require(sounder.beam_deg > 0 && sounder.beam_deg < 180, description, "beam_deg", sounder.beam_deg,
          "above 0 and below 180");
  require(sector_deg > 0 && sector_deg <= widest_deg, description, "sector_deg", sector_deg,
          "above 0 and at most 170");
  require(sounder.range_min_m >= 0, description, "range_min_m", sounder.range_min_m, "0 or more");
  require(sounder.range_max_m > sounder.range_min_m, description, "range_max_m", sounder.range_max_m,
          "above range_min_m");

  frequency_khz_ = sounder.frequency_khz;
  samples_ = {sounder.range_min_m, (sounder.range_max_m - sounder.range_min_m) / sounder.samples,
              sounder.samples};
  beams_.push_back({0, -radians(90), radians(sounder.beam_deg), radians(sounder.beam_deg)});

  const double half_rad = radians(sector_deg) / 2;
  // The grid's azimuth leans to starboard, its elevation forward. Two rows or more and as many columns: no
  // tube comes close to a half space.
  const int cells = half_rad > radians(45) ? 2 : 1;
  const int slices = std::max(cells, slices_for(2 * half_rad, description.cone_tolerance));
  const double corner_rad = height_of_corners(half_rad, 2 * half_rad / slices, description.cone_tolerance);
  Shot shot;
  shot.beams = {0};
  shot.sectors.push_back({even_edges(-half_rad, half_rad, slices), even_edges(-corner_rad, corner_rad, cells),
                          glm::dmat3(-up_axis, starboard_axis, forward_axis)});
  shot.beam_of_tube.assign(static_cast<std::size_t>(slices * cells), 0u);
  shot.fans.push_back(
      {0, 1, static_cast<std::uint32_t>(shot.beam_of_tube.size()), -up_axis, starboard_axis, forward_axis});
  shots_.push_back(std::move(shot));
}

}  // namespace tubefoot
