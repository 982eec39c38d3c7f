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

// How far what a view tells may be from what the mesh itself would: its vertices were put on a grid. Heavy:
// include only in .cpp files.
namespace tubefoot {

/// Axes of a view, enclosed: right, up and towards the viewer.
using EnclosedAxes = std::array<std::array<Ball, 3>, 3>;

/// Bounds the change of the integral over the silhouette of factor times e^{-2ikz}, z being how far the seen
/// place lies towards the viewer, when vertices move from where they are to where the grid has them.
/// docs/smooth-surfaces.md has the proof.
class ViewDisplacement {
 public:
  ViewDisplacement(const FarViewGrid& grid, std::span<const glm::dvec3> points_m,
                   std::span<const std::array<std::uint32_t, 3>> triangles, const PlacedEdges& edges,
                   const EnclosedAxes& axes);

  /// How far a vertex moved at most: across the line of sight, and along it.
  double across_m() const { return across_; }
  double towards_m() const { return towards_; }

  /// m^2. `area_m2`: of the silhouette that the view has. `largest`: of the modulus of any factor. `factors`
  /// by facet, where they are not all alike; which of two facets is seen that lie within the displacement of
  /// each other is then taken as the view has it.
  double bound_m2(double wave_number_per_m, double area_m2, double largest,
                  std::span<const ComplexBall> factors) const;

 private:
  struct Slanted {
    double slope, area_m2;  ///< area: of all places within reach of its projection
  };
  struct Inner {
    std::array<std::uint32_t, 2> facets;
    double area_m2;
  };

  double across_ = 0, towards_ = 0;
  double border_m2_ = 0;  ///< within reach of borders and vertices
  std::vector<Slanted> slanted_;
  std::vector<Inner> inner_;  ///< within reach of an edge on both sides of which its facets are seen
};

}  // namespace tubefoot
