// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/signal/placed_edges.hpp"
#include "engine/visibility/far_view.hpp"
#include "geometry/numbers/ball.hpp"

// Bounds the error of a view that comes from the rounding of the mesh's vertices to a grid. Source:
// docs/notes/smooth-surfaces.md. Heavy: include only in .cpp files.
namespace tubefoot {

/// Enclosed axes of a view: right, up and towards the viewer.
using EnclosedAxes = std::array<std::array<Ball, 3>, 3>;

/// Bounds the change of the integral over the silhouette of factor times e^{-2ikz} when the vertices move
/// from their true positions to the grid. The coordinate z of a visible place increases towards the viewer.
/// docs/notes/smooth-surfaces.md contains the proof.
class ViewDisplacement {
 public:
  ViewDisplacement(const FarViewGrid& grid, std::span<const glm::dvec3> points_m,
                   std::span<const std::array<std::uint32_t, 3>> triangles, const PlacedEdges& edges,
                   const EnclosedAxes& axes);

  /// Largest displacement of a vertex across and along the line of sight.
  double across_m() const { return across_; }
  double towards_m() const { return towards_; }

  /// Bound in m^2. `area_m2`: area of the view's silhouette. `largest`: bound of the modulus of all factors.
  /// `factors`: per facet if they differ. In that case, if two facets lie within the displacement of each
  /// other, the view decides which of the two is visible.
  double bound_m2(double wave_number_per_m, double area_m2, double largest,
                  std::span<const ComplexBall> factors) const;

 private:
  struct Slanted {
    double slope, area_m2;  ///< area of all places within the displacement of its projection
  };
  struct Inner {
    std::array<std::uint32_t, 2> facets;
    double area_m2;
  };

  double across_ = 0, towards_ = 0;
  double border_m2_ = 0;  ///< area within the displacement of borders and vertices
  std::vector<Slanted> slanted_;
  std::vector<Inner> inner_;  ///< area within the displacement of an edge with its facets visible on both
                              ///< sides
};

}  // namespace tubefoot
