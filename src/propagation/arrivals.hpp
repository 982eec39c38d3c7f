// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "engine/water/ray_trace.hpp"

// Eigenrays between two depths of stratified water, with reflections at a level surface and a level bottom.
namespace tubefoot {

/// Level reflectors, and limits of the rays that are searched.
struct ArrivalOptions {
  double surface_m = -std::numeric_limits<double>::infinity();  ///< depth; minus infinity: no surface
  double bottom_m = std::numeric_limits<double>::infinity();    ///< depth; infinity: no bottom
  int most_turns = 16;         ///< of rays without reflections; others may turn any number of times
  int most_reflections = 0;    ///< at surface and bottom together
  double finest_rad = 1.5e-3;  ///< largest step of launch angles in the search for reflected rays
};

/// An eigenray. Angles are positive downwards in the direction of travel.
struct RayArrival {
  double launch_rad = 0, arrival_rad = 0;
  double time_s = 0, length_m = 0;
  double absorption_db = 0;        ///< one way, along the path
  double tube_area_m2_per_sr = 0;  ///< as RayState::tube_area_m2_per_sr
  std::vector<double> turning_depths_m;
  int surface_reflections = 0, bottom_reflections = 0;
  /// Whether the ray has touched an odd number of caustics.
  bool crossed = false;

  int reflections() const { return surface_reflections + bottom_reflections; }
};

/// Returns all eigenrays, earliest first.
///
/// EigenrayFinder finds the rays without reflections. For the others, launch angles are traced at steps of
/// `finest_rad`. Intervals in which the order of turns and reflections changes are halved. A change of sign
/// of the depth, relative to the point, brackets an eigenray. Next to a caustic, a pair of reflected rays
/// that are closer together than a step can be missed. Vertical rays have closed forms.
///
/// The depths must lie between surface and bottom. Throws std::invalid_argument otherwise, and for a point at
/// the source.
std::vector<RayArrival> arrivals(const WaterColumn& water, double source_depth_m, double depth_m,
                                 double range_m, const ArrivalOptions& options);

/// Returns the nodes of an eigenray from the source to a horizontal range. A vertical ray has a node at each
/// end and at each reflection only.
std::vector<RayNode> path_of(const RayArrival& arrival, const WaterColumn& water, double source_depth_m,
                             double depth_m, double range_m, const ArrivalOptions& options);

/// Returns the depths at which a traced ray turns.
std::vector<double> turning_depths(const std::vector<RayNode>& nodes);

/// Returns the transmission loss by spreading in dB: the pressure at 1 m from the source relative to that at
/// the end of the ray. Its square is the intensity times the ratio of the impedances, for one density.
double spreading_loss_db(double tube_area_m2_per_sr, double source_speed_m_s, double speed_m_s);

}  // namespace tubefoot
