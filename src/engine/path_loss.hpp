// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace tubefoot {

/// What a chain of mirrors leaves of the energy that is sent along it, by the direction (unit vector) in
/// which its image apex sends.
struct MirrorLoss {
  /// Product of the factors that do not depend on direction.
  double factor = 1;
  /// One for each reflection at a rough surface: the surface's normal as the image apex sees it.
  std::vector<glm::dvec3> rough_normals;
  /// Coherent reflection at a rough surface, Rayleigh parameter 2 k sigma sin(grazing): intensity times
  /// exp(-(2 k sigma sin(grazing))^2) (Eckart 1953; Jensen et al., Computational Ocean Acoustics). Here
  /// (2 k sigma)^2.
  double roughness = 0;

  /// Not 0 for a patch that sends what it scatters by Lambert's law: its normal as the image sees it.
  glm::dvec3 cosine_axis{0};

  double at(glm::dvec3 direction) const {
    double passes = factor;
    if (cosine_axis != glm::dvec3(0)) passes *= std::max(0.0, glm::dot(direction, cosine_axis));
    if (rough_normals.empty()) return passes;
    double exponent = 0;
    for (const glm::dvec3& normal : rough_normals) {
      const double sine = glm::dot(direction, normal);
      exponent += sine * sine;
    }
    return passes * std::exp(-roughness * exponent);
  }
};

/// Of a path: mirrors on the way out and on the way back.
struct PathLoss {
  MirrorLoss transmit, receive;
  double before_m = 0;  ///< way that lies before the transmit apex and counts for range
};

}  // namespace tubefoot
