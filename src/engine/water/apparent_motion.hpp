// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>
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

  struct Velocity {
    glm::dvec3 at{0};        ///< of the apparent position, relative to the apex
    glm::dvec3 arrival{0};   ///< of CornerReturn::arrival
    double log_density = 0;  ///< of the logarithm of CornerReturn::density_per_m4
  };
  static constexpr std::size_t no_change = std::size_t(-1);
  /// `point` and `apex`: velocities in the local frame. `change`: number of a change of the water. The result
  /// is not finite on a caustic, and for a ray that is horizontal at its start or end and leaves its layer.
  Velocity of(glm::dvec3 point, glm::dvec3 apex, std::size_t change = no_change) const;

 private:
  /// Travel time; cosines at launch and arrival, divided by the range; sines at launch and arrival, positive
  /// down; logarithm of the density.
  enum : std::size_t { time, launch_across, launch_down, arrival_across, arrival_down, density, count };
  using Values = std::array<double, count>;

  glm::dvec3 along_{0};
  double range_m_, reference_speed_;
  Values at_{}, by_range_{}, by_depth_{}, by_apex_{};
  std::vector<Values> by_change_;
};

}  // namespace tubefoot
