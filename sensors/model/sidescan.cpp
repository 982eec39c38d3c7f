// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/model/sidescan.hpp"

#include "files/input_error.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot {

Sidescan::Sidescan(const SensorDescription& description)
    : Sidescan(description, std::get<SidescanDescription>(description.kind)) {}

Sidescan::Sidescan(const SensorDescription& description, const SidescanDescription& fan)
    : Sensor(description) {
  require(fan.samples >= 1, description, "samples", fan.samples, "1 or more");
  require(fan.along_track_deg > 0 && fan.along_track_deg < 180, description, "along_track_deg",
          fan.along_track_deg, "above 0 and below 180");
  require(fan.depression_min_deg >= -90 && fan.depression_min_deg < fan.depression_max_deg, description,
          "depression_min_deg", fan.depression_min_deg, "-90 or more and below depression_max_deg");
  require(fan.depression_max_deg <= 90, description, "depression_max_deg", fan.depression_max_deg,
          "at most 90: beyond, the fans of port and starboard overlap");
  require(fan.range_min_m >= 0, description, "range_min_m", fan.range_min_m, "0 or more");
  require(fan.range_max_m > fan.range_min_m, description, "range_max_m", fan.range_max_m,
          "above range_min_m");

  if (fan.sampling_frequency_khz)
    throw std::invalid_argument(fmt::format(
        "sensor '{}': its sampling frequency makes samples only with a speed of sound", description.name));

  frequency_khz_ = fan.frequency_khz;
  samples_ = {fan.range_min_m, (fan.range_max_m - fan.range_min_m) / fan.samples, fan.samples};

  const double shallow_rad = radians(fan.depression_min_deg), steep_rad = radians(fan.depression_max_deg);
  const double half_width_rad = radians(fan.along_track_deg) / 2;
  const double axis_rad =
      fan.axis_depression_deg ? radians(*fan.axis_depression_deg) : (shallow_rad + steep_rad) / 2;
  const int slices = slices_for(steep_rad - shallow_rad, description.cone_tolerance);
  const double corner_rad =
      height_of_corners(half_width_rad, (steep_rad - shallow_rad) / slices, description.cone_tolerance);
  Shot shot;
  shot.beams = {0, 1};
  for (const double side : {-1.0, 1.0}) {
    beams_.push_back({side * radians(90), -axis_rad, 2 * half_width_rad, steep_rad - shallow_rad});
    // The grid's azimuth is the depression angle: 0 horizontal to the side, 90 degrees straight down.
    shot.sectors.push_back({even_edges(shallow_rad, steep_rad, slices),
                            {-corner_rad, corner_rad},
                            glm::dmat3(side * starboard_axis, -up_axis, forward_axis)});
    shot.beam_of_tube.insert(shot.beam_of_tube.end(), static_cast<std::size_t>(slices), side < 0 ? 0u : 1u);
    const glm::dvec3 axis = std::cos(axis_rad) * side * starboard_axis - std::sin(axis_rad) * up_axis;
    const glm::dvec3 across = std::sin(axis_rad) * side * starboard_axis + std::cos(axis_rad) * up_axis;
    const auto beam = static_cast<std::uint32_t>(beams_.size());
    shot.fans.push_back(
        {beam - 1, beam, static_cast<std::uint32_t>(shot.beam_of_tube.size()), axis, forward_axis, across});
  }
  shots_.push_back(std::move(shot));
}

}  // namespace tubefoot
