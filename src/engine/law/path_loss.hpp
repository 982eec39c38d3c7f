// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "engine/law/scattering_law.hpp"

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

  double at(glm::dvec3 direction) const {
    if (rough_normals.empty()) return factor;
    double exponent = 0;
    for (const glm::dvec3& normal : rough_normals) {
      const double sine = glm::dot(direction, normal);
      exponent += sine * sine;
    }
    return factor * std::exp(-roughness * exponent);
  }
};

/// The part of sigma(i, s) = sqrt(sigma(i) sigma(s)) that belongs to one of the two grazing angles:
/// sqrt(sigma), for Lambert's law (no `law`) the sine, whose mu stands elsewhere.
inline double scattering_lobe(const ScatteringLaw* law, double sine) {
  sine = std::min(sine, 1.0);
  if (!(sine > 0)) return 0;
  return law == nullptr ? sine : std::sqrt(law->cross_section(sine, std::sqrt(1 - sine * sine)));
}

/// Of a path: mirrors on the way out and on the way back.
struct PathLoss {
  MirrorLoss transmit, receive;
};

}  // namespace tubefoot
