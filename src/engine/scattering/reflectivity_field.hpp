// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <span>

namespace tubefoot {

/// Parallel planes normal . place = offset + k spacing, for all integers k.
struct CellPlanes {
  glm::dvec3 normal{0, 0, 1};  ///< unit vector
  double offset_m = 0, spacing_m = 1;
};

/// Micro-texture: a factor of a material's diffuse scattering as a function of the position in the local
/// frame alone. Its mean over the seabed is 1. The same place has the same factor, to the last bit, in every
/// ping, on every machine and for any number of threads.
class ReflectivityField {
 public:
  virtual ~ReflectivityField() = default;

  /// Returns the factor, which is never negative.
  virtual double factor(glm::dvec3 place_m) const = 0;

  /// Returns an upper bound of all factors.
  virtual double largest() const = 0;

  /// Returns the shortest wavelength, in metres. The nodes of an integral must be much closer than this.
  virtual double finest_m() const = 0;

  /// Planes that divide space into cells. In each cell the factor is an analytic function of position, for
  /// example a polynomial. Across the planes it is continuous.
  virtual std::span<const CellPlanes> cells() const = 0;

  /// Returns a bound on the change of one cell's function over a distance `away_m`, for real and complex
  /// positions. The numbers of quadrature nodes follow from it.
  virtual double change(double away_m) const = 0;
};

}  // namespace tubefoot
