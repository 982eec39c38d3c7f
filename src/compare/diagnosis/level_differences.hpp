// SPDX-License-Identifier: GPL-3.0-or-later
// Differences of level between a candidate and its prediction: per ping, per material, and along the range
// or the elevation.
#pragma once

#include <vector>

#include "compare/diagnosis/residuals.hpp"
#include "compare/measures/energy_fit.hpp"

namespace tubefoot {

/// Gains of the pings of the candidate relative to their median.
struct PingGains {
  std::vector<double> factor;
  Estimate spread_db;  ///< largest minus smallest gain
};
PingGains ping_gains(const EchoShape& shape, std::span<const double> predicted_j,
                     std::span<const double> candidate_j);

/// Level of the candidate over a coordinate of the bins.
struct LevelProfile {
  std::vector<double> at, db;  ///< knots and levels relative to their largest
  double largest_db = 0;       ///< relative to the prediction
  Estimate spread_db;          ///< largest minus smallest level
  double misfit = 0;           ///< weighted mean square of the levels of patches that remains
};

/// Fits a piecewise linear level over the elevation of the bins.
LevelProfile level_over_elevation(const Residual& residual, std::span<const float> elevation_deg);
/// Fits a power of range and, in addition, a piecewise linear level over the range. `spread_db` is that of
/// the piecewise linear part alone.
LevelProfile level_over_range(const Residual& residual);

/// Level of each material relative to the prediction, in dB; `bins` is 0 for materials without echoes.
struct MaterialLevel {
  Estimate db;
  std::size_t bins = 0;
};
std::vector<MaterialLevel> material_levels(const Residual& residual, std::span<const std::uint16_t> material,
                                           std::size_t materials);
/// Largest minus smallest level of the materials with echoes.
Estimate spread_db(const std::vector<MaterialLevel>& levels);
/// Returns whether the spread exceeds 1 dB and five standard errors.
bool differ(const std::vector<MaterialLevel>& levels);

}  // namespace tubefoot
