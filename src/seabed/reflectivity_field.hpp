// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>

namespace tubefoot {

/// Micro-texture: a factor of a material's diffuse scattering that is a function of position in the local
/// frame and of nothing else. Its mean over the seabed is 1. The same place has the same factor, to the last
/// bit, in every ping, on every machine and for any number of threads.
class ReflectivityField {
 public:
  virtual ~ReflectivityField() = default;

  /// Never negative.
  virtual double factor(glm::dvec3 place_m) const = 0;

  /// No factor is larger.
  virtual double largest() const = 0;

  /// The shortest wavelength, metres: what an integral's nodes must be well closer than.
  virtual double finest_m() const = 0;
};

}  // namespace tubefoot
