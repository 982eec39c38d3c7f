// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <numbers>
#include <vector>

#include "engine/targets/strength_over_direction.hpp"
#include "geometry/numbers/world_grid.hpp"

// Targets in the water: points that scatter sound and hide nothing. A target of the cross-section sigma =
// 10^(TS/10) m^2 returns
//
//     sigma e^(-beta (r_tx + r_rx)) / (r_tx^2 r_rx^2)  [J/m^2 for 1 J/sr at 1 m]
//
// times the gains of the beam patterns, if both ends of the path see its place (Urick, Principles of
// Underwater Sound, active sonar equation).
namespace tubefoot {

/// Returns the cross-section in m^2 of a target strength in dB re 1 m^2.
inline double cross_section_m2(double target_strength_db) { return std::pow(10.0, target_strength_db / 10); }

/// A target at a grid point.
struct WaterTarget {
  GridPoint at;
  double cross_section_m2 = 0;  ///< for all directions, unless there is a table
  std::shared_ptr<const StrengthOverDirection> table{};
  glm::dquat attitude{1, 0, 0, 0};  ///< rotation of the axes of the table into the local frame

  /// Returns the cross-section in m^2 for directions of travel (not normalised) from the transmitter to the
  /// target and from the receiver to the target. With a separate receiver the table is read in the direction
  /// of the bisector, the monostatic approximation of a bistatic echo (Kell 1965).
  double cross_section(glm::dvec3 from_transmitter, glm::dvec3 from_receiver, double frequency_hz) const {
    if (table == nullptr) return cross_section_m2;
    glm::dvec3 towards = -(glm::normalize(from_transmitter) + glm::normalize(from_receiver));
    // Forward scattering has no bisector. The direction to the transmitter counts instead.
    if (!(glm::length(towards) > 1e-9)) towards = -from_transmitter;
    return table->at(glm::normalize(glm::conjugate(attitude) * towards), frequency_hz);
  }
};

/// Targets at random positions in a box. Positions and strengths depend only on the seed and on the place, so
/// that all pings and sensors meet the same targets.
struct TargetPopulation {
  glm::dvec3 lo_m{0}, hi_m{0};  ///< box in the local frame
  double density_per_m3 = 0;
  double target_strength_db = 0, spread_db = 0;  ///< mean and standard deviation, normally distributed
  std::uint64_t seed = 0;

  double volume_m3() const {
    const glm::dvec3 size = hi_m - lo_m;
    return size.x * size.y * size.z;
  }
  /// Returns the expected number of targets.
  double expected() const { return density_per_m3 * volume_m3(); }
  /// Returns the mean cross-section in m^2. The logarithm is normal, so that it exceeds the cross-section of
  /// the mean target strength.
  double mean_cross_section_m2() const {
    const double spread = std::numbers::ln10 / 10 * spread_db;
    return cross_section_m2(target_strength_db) * std::exp(spread * spread / 2);
  }
};

/// All targets of a scene.
struct WaterTargets {
  std::vector<WaterTarget> single;
  std::vector<TargetPopulation> populations;

  bool empty() const { return single.empty() && populations.empty(); }
};

}  // namespace tubefoot
