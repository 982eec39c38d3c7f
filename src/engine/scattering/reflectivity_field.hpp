// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <span>

namespace tubefoot {

/// Parallel planes normal . place = offset + k spacing, for all integers k.
struct CellPlanes {
  glm::dvec3 normal{0, 0, 1};  ///< unit
  double offset_m = 0, spacing_m = 1;
};

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

  /// Planes that cut space into cells, in each of which the factor is an analytic function of position (a
  /// polynomial, say). Across them it is continuous.
  virtual std::span<const CellPlanes> cells() const = 0;

  /// How far the function of one cell may leave its value at a place there, at places `away_m` from it, be
  /// they real or complex. What numbers of quadrature nodes follow from.
  virtual double change(double away_m) const = 0;
};

}  // namespace tubefoot
