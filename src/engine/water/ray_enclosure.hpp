// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>

#include "engine/water/apparent_map.hpp"
#include "geometry/numbers/interval.hpp"

namespace tubefoot {

/// Enclosures of the ray from an apex to every point of a patch. They contain every quantity that
/// ApparentMap computes at a point, and its derivatives along the two directions of a plane. Sines are
/// positive downwards.
struct RayJets {
  std::array<Jet, 3> image;  ///< apparent point, relative to the apex
  Jet time_s;
  /// In the following, d is the straight distance of the point. Terms that are equal in isovelocity water
  /// cancel before they are enclosed.
  Jet slowness_s_per_m;  ///< time / d
  Jet arrival_across;    ///< d cos(arrival) / range
  Jet arrival_down_m;    ///< d sin(arrival)
  /// For the next two quantities, only the value and the first derivatives are enclosed.
  Jet area_ratio_per_sr;  ///< area per steradian from the point back / d^2
  Jet absorption_db;
};

/// Encloses rays from one apex over patches of planes.
///
/// A patch is enclosed only if it is proven that exactly one ray leads to each of its points. The proof
/// considers the rays that ApparentMap follows, with at most one turning point.
///
/// The first kind of ray rises or falls monotonically through the layers. It exists if a bracket of its
/// Snell parameter k = p^2 is verified, because horizontal range grows with k. Its derivatives follow from
/// the implicit function k R(k, z)^2 = x^2 + y^2, where R = range / p. The second kind is the arc within one
/// layer, which has a closed form. All rays that turn elsewhere must be longer than the distance to the
/// patch's farthest point.
class RayEnclosure {
 public:
  /// Keeps a reference to the water of the apparent map. `options` are those of the apparent map.
  RayEnclosure(const ApparentMap& apparent_map, const EigenrayOptions& options);

  /// Encloses the rays to the points origin + a u + b v for a and b in the intervals. Positions are relative
  /// to the apex in the local frame. Returns nothing if it is not proven that one ray leads to each point.
  /// `alone` states that none_turns_before() holds for a patch that contains this one.
  std::optional<RayJets> over(const std::array<Interval, 3>& origin_m, const glm::dvec3& u,
                              const glm::dvec3& v, const Interval& a, const Interval& b,
                              bool alone = false) const;
  /// Returns true only if every turning ray is longer than the distance of the patch. The cost equals that
  /// of many patches for which the answer is known.
  bool none_turns_before(const std::array<Interval, 3>& origin_m, const glm::dvec3& u, const glm::dvec3& v,
                         const Interval& a, const Interval& b) const;

  glm::dvec3 apex_m() const { return apparent_map_.apex_m(); }
  double reference_speed_m_s() const { return reference_speed_; }
  /// No image is nearer than this factor times the distance of its point.
  double least_stretch() const { return least_stretch_; }
  /// No area per steradian to a point is less than this factor times the area from the point back.
  double least_area_ratio() const { return least_area_ratio_; }
  /// No image is displaced vertically from its point by more than this angle.
  double most_turn_rad() const { return most_turn_rad_; }

 private:
  struct Sums;
  bool no_ray_turns(const Interval& depth_m, double farthest_m) const;
  bool only_arc(std::size_t layer) const;
  /// With `beyond_m`, considers only rays that turn beyond this depth.
  bool turning_rays_are_longer(const Interval& depth_m, double farthest_m, bool below,
                               std::optional<double> beyond_m = {}) const;
  /// Returns whether all rays that leave a layer which contains both ends, and turn, are longer.
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
