// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/water/apparent_map.hpp"

// Derivatives of apparent positions and of the returns of facet corners by the point, by the apex and by the
// water. The layers of each ray, the number of its turning points and the reference speed stay fixed. See
// docs/notes/gradients.md.
namespace tubefoot {

/// Change of a water column per unit of a parameter.
struct WaterChange {
  std::vector<double> sound_speed_m_s{};  ///< by point of the profile; empty: no change
  double absorption_db_per_m = 0;         ///< one way, in every layer
};

/// Derivatives of the apparent position and of the return of one point.
class ApparentMotion {
 public:
  /// `image`: a result of apparent() for this point. Throws std::invalid_argument for a map with mirrors or
  /// with a surface apex, and for a change with another number of profile points.
  ApparentMotion(const ApparentMap& apparent_map, glm::dvec3 point_m, const ApparentPoint& image,
                 std::span<const WaterChange> changes = {});

  /// The same for one change per point of the profile, in order: 1 m/s there. The next change is an
  /// absorption of 1 dB/m in every layer. Memory does not depend on the number of points that the ray does
  /// not reach.
  struct ByProfilePoint {};
  ApparentMotion(const ApparentMap& apparent_map, glm::dvec3 point_m, const ApparentPoint& image,
                 ByProfilePoint);

  struct Velocity {
    glm::dvec3 at{0};        ///< of the apparent position, relative to the apex
    glm::dvec3 arrival{0};   ///< of CornerReturn::arrival
    double log_density = 0;  ///< of the logarithm of CornerReturn::density_per_m4
  };
  static constexpr std::size_t no_change = std::size_t(-1);
  /// A change of the water, and its effect on the values of a ray.
  using Values = std::array<double, 6>;
  using Effect = std::pair<std::size_t, Values>;
  /// Effects by increasing number of the change. Changes without an effect may be missing.
  std::span<const Effect> effects() const { return effects_; }
  /// `point` and `apex`: velocities in the local frame. `change`: number of a change of the water. The result
  /// is not finite on a caustic, and for a ray that is horizontal at its start or end and leaves its layer.
  Velocity of(glm::dvec3 point, glm::dvec3 apex, std::size_t change = no_change) const;

 private:
  /// Travel time; cosines at launch and arrival, divided by the range; sines at launch and arrival, positive
  /// down; logarithm of the density.
  enum : std::size_t { time, launch_across, launch_down, arrival_across, arrival_down, density, count };
  static_assert(std::tuple_size_v<Values> == count);

  /// Returns the effects of 1 m/s at the points of the profile on which the ray depends.
  std::vector<Effect> trace(const ApparentMap& apparent_map, glm::dvec3 point_m, const ApparentPoint& image,
                            bool by_points);

  glm::dvec3 along_{0};
  double range_m_ = 0, reference_speed_ = 0;
  Values at_{}, by_range_{}, by_depth_{}, by_apex_{};
  std::vector<Effect> effects_;
};

}  // namespace tubefoot
