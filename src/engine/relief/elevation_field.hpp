// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>

namespace tubefoot {

/// Macro-texture: relief of the seabed as a function of the position in the local frame alone. The same place
/// has the same height, to the last bit, in every ping, on every machine and for any number of threads.
class ElevationField {
 public:
  virtual ~ElevationField() = default;

  /// Returns the height above the facet at a place of the undisplaced seabed, in metres.
  virtual double height_m(glm::dvec3 place_m) const = 0;

  /// Returns an upper bound of the magnitude of all heights, in metres.
  virtual double largest_m() const = 0;

  /// Returns the size of the smallest detail, in metres. A mesh with shorter edges shows no further detail.
  virtual double finest_m() const = 0;

  /// The part of the field that a mesh with edges of a given length does not represent. It is the difference
  /// from the linear interpolation over triangles in plan view. Slopes are metres of height per horizontal
  /// metre.
  struct LeftOut {
    /// Estimates, for edges of exactly this length.
    double rms_height_m = 0, rms_slope = 0;
    /// Upper bounds, for all triangles with edges of at most this length. The bound of slopes also requires
    /// angles of at most 120 degrees, because no bound holds for all slivers.
    double largest_height_m = 0, largest_slope = 0;
  };
  virtual LeftOut left_out(double edge_m) const = 0;
};

}  // namespace tubefoot
