// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/model/fan_sector.hpp"

#include <algorithm>

#include "sensors/model/angles.hpp"

namespace tubefoot {

SectorTubes even_sector(int beams, double half_width_rad, double half_lit_rad, double half_height_rad,
                        double cone_tolerance) {
  // Surfaces of constant elevation are cones, while tubes have planes. A wide beam therefore has several
  // slices (see slice_width_rad).
  const int slices = slices_for(2 * half_width_rad / beams, cone_tolerance);
  const double corner_rad =
      height_of_corners(half_height_rad, 2 * half_width_rad / beams / slices, cone_tolerance);
  // Two rows above 90 degrees, so that no tube approaches a half space. The rays of such a tube would not
  // determine it.
  const int rows = half_height_rad > radians(45) ? 2 : 1;
  const std::vector<double> edges = even_edges(-half_width_rad, half_width_rad, beams * slices);
  SectorTubes made{
      {{}, even_edges(-corner_rad, corner_rad, rows), glm::dmat3(forward_axis, starboard_axis, up_axis)}, {}};
  std::vector<double>& azimuths = made.grid.azimuth_edges_rad;
  for (std::size_t cell = 0; cell + 1 < edges.size(); ++cell) {
    const double from = std::max(edges[cell], -half_lit_rad), to = std::min(edges[cell + 1], half_lit_rad);
    if (to - from < 1e-8) continue;  // not insonified, or too narrow for integer rays to resolve its walls
    if (azimuths.empty()) azimuths.push_back(from);
    azimuths.push_back(to);
    made.beam_of_tube.insert(made.beam_of_tube.end(), static_cast<std::size_t>(rows),
                             static_cast<std::uint32_t>(cell) / static_cast<std::uint32_t>(slices));
  }
  return made;
}

SectorTubes sector_between(const std::vector<double>& borders_rad, double half_height_rad,
                           double cone_tolerance) {
  double widest_rad = 0;  // widest slice; all slices have the same height
  for (std::size_t beam = 0; beam + 1 < borders_rad.size(); ++beam) {
    const double width_rad = borders_rad[beam + 1] - borders_rad[beam];
    widest_rad = std::max(widest_rad, width_rad / slices_for(width_rad, cone_tolerance));
  }
  const double corner_rad = height_of_corners(half_height_rad, widest_rad, cone_tolerance);
  const int rows = half_height_rad > radians(45) ? 2 : 1;  // as above
  SectorTubes made{{{borders_rad.front()},
                    even_edges(-corner_rad, corner_rad, rows),
                    glm::dmat3(forward_axis, starboard_axis, up_axis)},
                   {}};
  for (std::size_t beam = 0; beam + 1 < borders_rad.size(); ++beam) {
    const int slices = slices_for(borders_rad[beam + 1] - borders_rad[beam], cone_tolerance);
    const std::vector<double> edges = even_edges(borders_rad[beam], borders_rad[beam + 1], slices);
    std::vector<double>& azimuths = made.grid.azimuth_edges_rad;
    azimuths.insert(azimuths.end(), edges.begin() + 1, edges.end());
    made.beam_of_tube.insert(made.beam_of_tube.end(), static_cast<std::size_t>(slices * rows),
                             static_cast<std::uint32_t>(beam));
  }
  return made;
}

}  // namespace tubefoot
