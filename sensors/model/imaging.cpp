// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/model/imaging.hpp"

#include <numeric>
#include <utility>

#include "sensors/model/angles.hpp"
#include "sensors/model/fan_sector.hpp"

namespace tubefoot {

Imaging::Imaging(const SensorDescription& description) : Sensor(description) {
  const auto& fan = std::get<ImagingDescription>(description.kind);
  require(fan.beams >= 1, description, "beams", fan.beams, "1 or more");
  require(fan.samples >= 1, description, "samples", fan.samples, "1 or more");
  require(fan.horizontal_deg > 0 && fan.horizontal_deg <= 360, description, "horizontal_deg",
          fan.horizontal_deg, "above 0 and at most 360");
  require(fan.vertical_deg > 0 && fan.vertical_deg < 180, description, "vertical_deg", fan.vertical_deg,
          "above 0 and below 180");
  require(fan.range_min_m >= 0, description, "range_min_m", fan.range_min_m, "0 or more");
  require(fan.range_max_m > fan.range_min_m, description, "range_max_m", fan.range_max_m,
          "above range_min_m");

  frequency_khz_ = fan.frequency_khz;
  samples_ = {fan.range_min_m, (fan.range_max_m - fan.range_min_m) / fan.samples, fan.samples};
  const double half_width_rad = radians(fan.horizontal_deg) / 2;
  const double half_height_rad = radians(fan.vertical_deg) / 2;
  const double beam_width_rad = 2 * half_width_rad / fan.beams;
  for (int beam = 0; beam < fan.beams; ++beam)
    beams_.push_back(
        {-half_width_rad + (beam + 0.5) * beam_width_rad, 0, beam_width_rad, 2 * half_height_rad});

  SectorTubes sector =
      even_sector(fan.beams, half_width_rad, half_width_rad, half_height_rad, description.cone_tolerance);
  Shot shot;
  shot.beams.resize(beams_.size());
  std::iota(shot.beams.begin(), shot.beams.end(), 0u);
  shot.fans.push_back({0, static_cast<std::uint32_t>(beams_.size()),
                       static_cast<std::uint32_t>(sector.beam_of_tube.size()), forward_axis, starboard_axis,
                       up_axis});
  shot.beam_of_tube = std::move(sector.beam_of_tube);
  shot.sectors.push_back(std::move(sector.grid));
  shots_.push_back(std::move(shot));
}

}  // namespace tubefoot
