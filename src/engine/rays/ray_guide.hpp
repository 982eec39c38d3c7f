// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <vector>

namespace tubefoot {

/// What rays are sent for, so far as adaptive ones go by it. How many rays go where depends on it, never what
/// they stand for: with another guide energies are as right, on average, and scatter more.
struct RayGuide {
  /// Samples of half paths, [first, first + count step); count 0: it does not matter how far anything is.
  double first_m = 0, step_m = 0;
  int count = 0;
  double absorption_per_m = 0;              ///< of energy, one way
  std::vector<double> material_strength{};  ///< by material, in any unit; empty: all alike
  glm::dvec3 receiver_m{0};                 ///< from the apex
};

}  // namespace tubefoot
