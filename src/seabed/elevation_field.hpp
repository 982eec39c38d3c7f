// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>

namespace tubefoot {

/// Macro-texture: relief below the facet, a function of position in the local frame and of nothing else. The
/// same place has the same height, to the last bit, in every ping, on every machine and for any number of
/// threads.
class ElevationField {
 public:
  virtual ~ElevationField() = default;

  /// Height above the facet at a place of the undisplaced seabed, metres.
  virtual double height_m(glm::dvec3 place_m) const = 0;

  /// No height is larger in magnitude, metres.
  virtual double largest_m() const = 0;

  /// The smallest detail, metres: a mesh of shorter edges shows nothing more.
  virtual double finest_m() const = 0;

  /// What a mesh with edges of a given length leaves out of the field.
  struct LeftOut {
    double rms_height_m = 0, rms_slope = 0;
    double largest_height_m = 0, largest_slope = 0;
  };
  virtual LeftOut left_out(double edge_m) const = 0;
};

}  // namespace tubefoot
