// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <vector>

namespace tubefoot {

/// Data by which adaptive rays are distributed. The guide affects the number of rays in each direction but
/// not their weights. With another guide the energies are equally correct on average but have a larger
/// variance.
struct RayGuide {
  /// Samples of half path lengths, [first, first + count step). With count 0 the distance has no influence.
  double first_m = 0, step_m = 0;
  int count = 0;
  double absorption_per_m = 0;              ///< of energy, one way
  std::vector<double> material_strength{};  ///< per material, in any unit; empty: equal for all
  glm::dvec3 receiver_m{0};                 ///< relative to the apex
};

}  // namespace tubefoot
