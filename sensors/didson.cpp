// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/didson.hpp"

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

  // Walls of constant elevation are cones, tubes have planes: wide beams are several slices (see
  // slice_width_rad).
  const int slices = slices_for(beam_width_rad);
  // Two rows above 90 degrees: no tube comes close to a half space, where its rays would say nothing.
  const int rows = camera.vertical_deg > 90 ? 2 : 1;
  sectors_.push_back({even_edges(-half_horizontal_rad, half_horizontal_rad, camera.beams * slices),
                      even_edges(-half_vertical_rad, half_vertical_rad, rows),
                      glm::dmat3(forward_axis, starboard_axis, up_axis)});
  for (int tube = 0; tube < camera.beams * slices * rows; ++tube)
    beam_of_tube_.push_back(static_cast<std::uint32_t>(tube / (slices * rows)));
}

}  // namespace tubefoot
