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

/// Where the vertical line through a point crosses a component of the mesh.
struct VerticalCrossings {
  std::uint16_t component = 0;
  std::size_t above = 0, below = 0;  ///< facets crossed; one that holds the point counts as below the point
  double lowest_above = 0;           ///< height of the lowest crossing above the point over it, grid units
  double highest_below = 0;          ///< depth of the highest crossing below the point under it, grid units
};

/// Appends the facets that may meet the vertical line through a point; none that does is missing.
void facets_near_vertical(const SceneTree& tree, GridPoint point, std::vector<FacetId>& out);
/// The same for facets that are moved by up to `margin` (grid units) before they meet it.
void facets_near_vertical(const SceneTree& tree, GridPoint point, double margin, std::vector<FacetId>& out);

/// Where the vertical line through a point crosses a facet: +1 above the point, -1 at the point or below, 0
/// nowhere. Exact; the line is moved aside as below.
int vertical_side(const FacetMesh& mesh, FacetId facet, GridPoint point);

/// What of the mesh a point lies on.
struct FacetContact {
  enum class Part { vertex, edge, facet } part = Part::facet;
  std::uint16_t component = 0;
};
/// Exact; of several facets, that of the lowest id. Facets without area are nothing to lie on. `near`: from
/// facets_near_vertical().
/// Law F3 (contact): a point in a facet, on an edge or at a vertex is reported, one a grid unit off is not.
std::optional<FacetContact> contact_at(const FacetMesh& mesh, std::span<const FacetId> near, GridPoint point);

/// Crossings per component that the line meets, exactly: a line through an edge or a vertex is moved aside by
/// an infinitesimal step, so that a closed surface is crossed an even number of times in all. `near`: from
/// facets_near_vertical().
std::vector<VerticalCrossings> vertical_crossings(const FacetMesh& mesh, std::span<const FacetId> near,
                                                  GridPoint point);

/// Whether a closed shell goes all round a point that lies on none of its facets: exactly, by the crossings
/// of each shell above the point. A point in a hollow of a body is enclosed. `near`: from
/// facets_near_vertical(), of the mesh that the shells are of. Law F4 (enclosed): no way out of there misses
/// the shell; one on a facet's other side does.
bool is_enclosed(const FacetMesh& mesh, const ClosedShells& shells, std::span<const FacetId> near,
                 GridPoint point);

}  // namespace tubefoot
