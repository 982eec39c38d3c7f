// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// A sector cut into tubes, and which beam each belongs to.
struct SectorTubes {
  AngularGrid grid;  ///< in the sensor's frame, ahead
  std::vector<std::uint32_t> beam_of_tube;
};

/// A fan ahead of `beams` equal azimuth cells over twice `half_width_rad`, each over the whole of twice
/// `half_height_rad`; of them only what lies within `half_lit_rad` of the middle is cut into tubes. Wide
/// beams are several tubes (slice_width_rad), high fans two rows.
SectorTubes even_sector(int beams, double half_width_rad, double half_lit_rad, double half_height_rad,
                        double cone_tolerance);

/// The same of beams that lie between these borders, which increase.
SectorTubes sector_between(const std::vector<double>& borders_rad, double half_height_rad,
                           double cone_tolerance);

}  // namespace tubefoot
