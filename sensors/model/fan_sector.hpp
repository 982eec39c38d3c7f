// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// A sector cut into tubes, and the beam of each tube.
struct SectorTubes {
  AngularGrid grid;  ///< in the sensor's frame, ahead
  std::vector<std::uint32_t> beam_of_tube;
};

/// A fan ahead of `beams` equal azimuth cells over twice `half_width_rad`, each over twice
/// `half_height_rad`. Only the part within `half_lit_rad` of the middle is cut into tubes. Wide beams have
/// several tubes (slice_width_rad), and high fans have two rows.
SectorTubes even_sector(int beams, double half_width_rad, double half_lit_rad, double half_height_rad,
                        double cone_tolerance);

/// The same for beams between these borders, which must increase.
SectorTubes sector_between(const std::vector<double>& borders_rad, double half_height_rad,
                           double cone_tolerance);

}  // namespace tubefoot
