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

  /// What a mesh with edges of a given length leaves out of the field: its difference from its linear
  /// interpolation over triangles in plan view. Slopes are metres of height per horizontal metre.
  struct LeftOut {
    /// Estimates: of edges just as long.
    double rms_height_m = 0, rms_slope = 0;
    /// Bounds: of every triangle whose edges are no longer; for slopes, whose angles also are 120 degrees at
    /// most (no bound holds for all slivers).
    double largest_height_m = 0, largest_slope = 0;
  };
  virtual LeftOut left_out(double edge_m) const = 0;
};

}  // namespace tubefoot
