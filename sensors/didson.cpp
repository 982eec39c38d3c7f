// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/didson.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "sensors/angles.hpp"

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
  // Walls of constant elevation are cones, tubes have planes: wide beams are several slices (see
  // slice_width_rad).
  const int slices = slices_for(beam_width_rad);
  // Two rows above 90 degrees: no tube comes close to a half space, where its rays would say nothing.
  const int rows = half_height_rad > radians(45) ? 2 : 1;
  const std::vector<double> edges =
      even_edges(-half_horizontal_rad, half_horizontal_rad, camera.beams * slices);
  Shot shot;
  shot.beams.resize(beams_.size());
  std::iota(shot.beams.begin(), shot.beams.end(), 0u);
  AngularGrid lit{{},
                  even_edges(-half_height_rad, half_height_rad, rows),
                  glm::dmat3(forward_axis, starboard_axis, up_axis)};
  for (std::size_t cell = 0; cell + 1 < edges.size(); ++cell) {
    const double from = std::max(edges[cell], -half_transmit_rad),
                 to = std::min(edges[cell + 1], half_transmit_rad);
    if (to - from < 1e-8) continue;  // unlit, or so narrow that integer rays cannot tell its walls apart
    if (lit.azimuth_edges_rad.empty()) lit.azimuth_edges_rad.push_back(from);
    lit.azimuth_edges_rad.push_back(to);
    shot.beam_of_tube.insert(shot.beam_of_tube.end(), static_cast<std::size_t>(rows),
                             static_cast<std::uint32_t>(cell) / static_cast<std::uint32_t>(slices));
  }
  shot.sectors.push_back(std::move(lit));
  shot.fans.push_back({0, static_cast<std::uint32_t>(beams_.size()),
                       static_cast<std::uint32_t>(shot.beam_of_tube.size()), forward_axis, starboard_axis,
                       up_axis});
  shots_.push_back(std::move(shot));
}

}  // namespace tubefoot
