// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

struct CoarseMesh {
  FacetMesh mesh;
  /// By facet of it: no point on it has been moved farther from where it was, grid units; 0: as it was.
  std::vector<double> move;
  /// By facet: no point on it faces farther from where it faced, radians.
  std::vector<double> turn_rad;
  double largest_share = 0;  ///< of `most_move`, at most 1
};

/// The same surface in fewer facets, within limits: vertices go one by one, each onto a neighbour, cheapest
/// first, as long as no point of the surface is moved by more than `most_move` of the facet that it was on
/// (grid units; facets with 0 keep their corners), nor turned by more than `most_turn_rad`. Those that stay
/// keep their place and their id; facets keep their order. Vertices on borders of sheets, of components and
/// of materials stay, and so do those whose facets are no disk (docs/coarse.md).
/// Law N4 (one to one): each step maps the disk about a vertex, along a direction in which both are seen
///   spread out, one to one onto the disk that takes its place, and leaves its border; so does what the steps
///   add up to, from the mesh onto the coarse one. `move` bounds how far that moves points, thus the distance
///   of the two surfaces both ways; `turn_rad` how far the normals at a point and at its image are apart. To
///   rounding.
/// Law N5 (topology): closed sheets stay closed, borders stay as they are, and no two facets come to share
///   three corners.
CoarseMesh coarsened(const FacetMesh& mesh, std::span<const double> most_move, double most_turn_rad);

}  // namespace tubefoot
