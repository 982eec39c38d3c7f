// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "engine/scattering/map_reflectivity.hpp"
#include "engine/scattering/perlin_reflectivity.hpp"

namespace tubefoot {

/// A reflectivity texture with its gradient: Perlin noise, maps, and products of these. A map is bilinear
/// between the centres of pixels. Its gradient jumps across their rows and columns, and is the one of the
/// cell that ReflectivityField::cells() defines.
class ReflectivityGradient {
 public:
  /// `field` must outlive this object. Throws std::invalid_argument for a field of another kind.
  explicit ReflectivityGradient(const ReflectivityField& field);

  struct Value {
    double factor = 1;
    glm::dvec3 gradient{0};  ///< per metre
  };
  Value at(glm::dvec3 place_m) const;

  /// Returns the degree of the factor as a polynomial along a straight line in a cell.
  int degree() const { return 2 * int(maps_.size()) + 18 * int(noises_.size()); }

 private:
  void add(const ReflectivityField& field);

  std::vector<const MapReflectivity*> maps_;
  std::vector<const PerlinReflectivity*> noises_;
};

}  // namespace tubefoot
