// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>

#include "engine/water/apparent_map.hpp"
#include "geometry/numbers/interval.hpp"

namespace tubefoot {

/// The ray from an apex to every point of a patch, enclosed: all that Apparent map computes at a point, with
/// derivatives along the two directions of a plane. Sines are positive downwards.
struct RayJets {
  std::array<Jet, 3> image;  ///< apparent point, relative to the apex
  Jet time_s;
  /// With d the straight distance of the point, so that what is alike in isovelocity water cancels before it
  /// is enclosed:
  Jet slowness_s_per_m;  ///< time / d
  Jet arrival_across;    ///< d cos(arrival) / range
  Jet arrival_down_m;    ///< d sin(arrival)
  /// Of these two only value and first derivatives are enclosed.
  Jet area_ratio_per_sr;  ///< area per steradian from the point back / d^2
  Jet absorption_db;
};

/// Encloses rays from one apex over patches of planes.
///
/// A patch is enclosed only if it is proven that exactly one ray of those that Apparent map follows
/// (without, or with one turning point) leads to each of its points: through layers the one that rises or
/// falls all the way, which exists where a bracket of its Snell parameter k = p^2 is verified (horizontal
/// range grows with k), or the arc within one layer, by its closed form; and rays that turn elsewhere are all
/// longer than the patch's farthest point. Derivatives through layers follow from the implicit function k
/// R(k, z)^2 = x^2 + y^2, where R = range / p.
class RayEnclosure {
 public:
  /// Refers to the apparent map's water. `options`: as its own.
  RayEnclosure(const ApparentMap& apparent_map, const EigenrayOptions& options);

  /// Over the points origin + a u + b v, relative to the apex, local frame, for a and b in the intervals.
  /// None where it is not proven that there is one ray. `alone`: none_turns_before() is known of a patch that
  /// holds this one.
  std::optional<RayJets> over(const std::array<Interval, 3>& origin_m, const glm::dvec3& u,
                              const glm::dvec3& v, const Interval& a, const Interval& b,
                              bool alone = false) const;
  /// True only if every ray that turns is longer than the patch is far. Costs as much as many patches of one
  /// already known.
  bool none_turns_before(const std::array<Interval, 3>& origin_m, const glm::dvec3& u, const glm::dvec3& v,
                         const Interval& a, const Interval& b) const;

  glm::dvec3 apex_m() const { return apparent_map_.apex_m(); }
  double reference_speed_m_s() const { return reference_speed_; }
  /// No image is nearer than this times its point.
  double least_stretch() const { return least_stretch_; }
  /// No area per steradian to a point is less than this times that from the point back.
  double least_area_ratio() const { return least_area_ratio_; }
  /// No image is seen farther than this above or below its point.
  double most_turn_rad() const { return most_turn_rad_; }

 private:
  struct Sums;
  bool no_ray_turns(const Interval& depth_m, double farthest_m) const;
  bool only_arc(std::size_t layer) const;
  /// `beyond_m`: those alone that turn there.
  bool turning_rays_are_longer(const Interval& depth_m, double farthest_m, bool below,
                               std::optional<double> beyond_m = {}) const;
  /// Rays that leave a layer that holds both ends, and turn, are longer.
  bool no_ray_comes_back(std::size_t layer, const Interval& depth_m, double farthest_m) const;
  std::optional<RayJets> within_layer(std::size_t layer, const Jet& x, const Jet& y, const Jet& depth,
                                      bool alone) const;
  std::optional<RayJets> through_layers(const Jet& x, const Jet& y, const Jet& depth, bool alone) const;
  Sums sums_to(double depth_m, const Interval& k) const;
  bool extend(Sums& sums, const Interval& k, double from_m, double to_m) const;

  const ApparentMap& apparent_map_;
  EigenrayOptions options_;
  EigenrayFinder finder_;
  double source_m_, source_speed_, reference_speed_;
  double least_stretch_ = 1, least_area_ratio_ = 1, most_turn_rad_ = 0;
};

}  // namespace tubefoot
