// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/mesh/closed_shells.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/search/scene_tree.hpp"

namespace tubefoot {

/// Crossings of the vertical line through a point with a component of the mesh.
struct VerticalCrossings {
  std::uint16_t component = 0;
  std::size_t above = 0,
              below = 0;  ///< number of facets crossed; a facet that contains the point counts as below
  double lowest_above =
      0;  ///< height of the lowest crossing above the point, relative to the point, grid units
  double highest_below =
      0;  ///< depth of the highest crossing below the point, relative to the point, grid units
};

/// Appends all facets that may meet the vertical line through a point.
void facets_near_vertical(const SceneTree& tree, GridPoint point, std::vector<FacetId>& out);
/// The same for facets that may be moved by up to `margin` (grid units) before they meet the line.
void facets_near_vertical(const SceneTree& tree, GridPoint point, double margin, std::vector<FacetId>& out);

/// Returns the position at which the vertical line through a point crosses a facet: +1 above the point, -1 at
/// the point or below, 0 without a crossing. Exact; the line is displaced as in vertical_crossings().
int vertical_side(const FacetMesh& mesh, FacetId facet, GridPoint point);

/// The element of the mesh on which a point lies.
struct FacetContact {
  enum class Part { vertex, edge, facet } part = Part::facet;
  std::uint16_t component = 0;
};
/// Returns the contact of a point with the mesh, exactly. If several facets contain the point, the lowest id
/// is used. Facets without area are ignored. `near` comes from facets_near_vertical().
///
/// Law F3 (contact): a point in a facet, on an edge or at a vertex is reported. A point that is one grid unit
/// away is not.
std::optional<FacetContact> contact_at(const FacetMesh& mesh, std::span<const FacetId> near, GridPoint point);

/// Returns the crossings per component that the line meets, exactly. A line through an edge or a vertex is
/// displaced by an infinitesimal step. The total number of crossings with a closed surface is therefore even.
/// `near` comes from facets_near_vertical().
std::vector<VerticalCrossings> vertical_crossings(const FacetMesh& mesh, std::span<const FacetId> near,
                                                  GridPoint point);

/// Returns whether a closed shell encloses a point that lies on none of its facets. The result is exact and
/// follows from the number of crossings of each shell above the point. A point in a cavity of a body is
/// enclosed. `near` comes from facets_near_vertical(), for the mesh of the shells.
///
/// Law F4 (enclosed): every path from an enclosed point to the outside meets the shell. A point on the other
/// side of a facet has a path that does not.
bool is_enclosed(const FacetMesh& mesh, const ClosedShells& shells, std::span<const FacetId> near,
                 GridPoint point);

}  // namespace tubefoot
