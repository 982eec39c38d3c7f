// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "propagation/rays_request.hpp"

namespace tubefoot {

/// Request of a BELLHOP environment file: rays of given launch angles, or arrivals at a grid of points.
struct BellhopRun {
  std::vector<double> ranges_m;    ///< of the points; of a fan, the last is its end
  std::vector<double> depths_m;    ///< of the points; empty: a fan of rays
  std::vector<double> angles_deg;  ///< launch angles of the fan, or the two ends of those of the beams
  double frequency_hz = 1000;      ///< BELLHOP joins arrivals whose phases differ by less than 0.05 rad
};

/// Returns the launch angles in degrees between which beams must lie for these eigenrays.
std::vector<double> beam_angles_deg(const std::vector<PointArrivals>& points);

/// Returns an environment file of BELLHOP for the water, the source and the run. The sound speed is linear
/// between the same points, and the step is the automatic one. The surface is a vacuum. The bottom is rigid,
/// or a half-space like the water without a reflecting bottom. The file contains no absorption. Throws
/// UsageError for water without a surface.
std::string bellhop_environment(const RaysRequest& request, const BellhopRun& run);

}  // namespace tubefoot
