// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/didson.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "sensors/angles.hpp"
#include "sensors/fan_sector.hpp"

namespace tubefoot {

Didson::Didson(const SensorDescription& description) : Sensor(description) {
  const auto& camera = std::get<DidsonDescription>(description.kind);
  require(camera.beams >= 1, description, "beams", camera.beams, "1 or more");
  require(camera.samples >= 1, description, "samples", camera.samples, "1 or more");
  require(camera.horizontal_deg > 0 && camera.horizontal_deg <= 360, description, "horizontal_deg",
          camera.horizontal_deg, "above 0 and at most 360");
  require(camera.vertical_deg > 0 && camera.vertical_deg < 180, description, "vertical_deg",
          camera.vertical_deg, "above 0 and below 180");
  for (const auto& transmit : {camera.transmit_horizontal_deg, camera.transmit_vertical_deg})
    require(!transmit || (*transmit > 0 && *transmit < 360), description, "transmit sector",
            transmit.value_or(0), "above 0 and below 360");
  require(camera.window_start_m >= 0, description, "window_start_m", camera.window_start_m, "0 or more");
  require(camera.window_length_m > 0, description, "window_length_m", camera.window_length_m, "above 0");

  frequency_khz_ = camera.frequency_khz;
  samples_ = {camera.window_start_m, camera.window_length_m / camera.samples, camera.samples};

  const double half_horizontal_rad = radians(camera.horizontal_deg) / 2;
  const double half_vertical_rad = radians(camera.vertical_deg) / 2;
  const double beam_width_rad = 2 * half_horizontal_rad / camera.beams;
  for (int beam = 0; beam < camera.beams; ++beam)
    beams_.push_back(
        {-half_horizontal_rad + (beam + 0.5) * beam_width_rad, 0, beam_width_rad, 2 * half_vertical_rad});

  // An echo needs both: of each receive beam, only the part within the transmit sector is cut into tubes. The
  // two sectors share apex and axes, so that their intersection is one of angles.
  const double half_transmit_rad =
      radians(
          std::min(camera.transmit_horizontal_deg.value_or(camera.horizontal_deg), camera.horizontal_deg)) /
      2;
  const double half_height_rad =
      radians(std::min(camera.transmit_vertical_deg.value_or(camera.vertical_deg), camera.vertical_deg)) / 2;
  SectorTubes lit = even_sector(camera.beams, half_horizontal_rad, half_transmit_rad, half_height_rad);
  Shot shot;
  shot.beams.resize(beams_.size());
  std::iota(shot.beams.begin(), shot.beams.end(), 0u);
  shot.beam_of_tube = std::move(lit.beam_of_tube);
  shot.sectors.push_back(std::move(lit.grid));
  shot.fans.push_back({0, static_cast<std::uint32_t>(beams_.size()),
                       static_cast<std::uint32_t>(shot.beam_of_tube.size()), forward_axis, starboard_axis,
                       up_axis});
  shots_.push_back(std::move(shot));
}

}  // namespace tubefoot
