// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

struct CoarseMesh {
  FacetMesh mesh;
  /// Per facet of `mesh`: upper bound on the displacement of its points from their original positions, in
  /// grid units; 0 if unchanged.
  std::vector<double> move;
  /// Per facet: upper bound on the rotation of the normal at its points, in radians.
  std::vector<double> turn_rad;
  double largest_share = 0;  ///< largest displacement as a share of `most_move`, at most 1
};

/// Reduces the number of facets of a surface within limits. Vertices are removed one by one in the order of
/// their cost, each by moving it onto a neighbour. No point of the surface is moved by more than `most_move`
/// of the facet on which it was, in grid units. Facets with the limit 0 keep their corners. No normal is
/// turned by more than `most_turn_rad`.
///
/// The remaining vertices keep their position and their id, and facets keep their order. Vertices on borders
/// of open surfaces, of components and of materials stay. Vertices whose facets do not form a disk stay too
/// (docs/notes/visibility.md).
///
/// Law N4 (one to one): each step maps the disk about a vertex one to one onto the disk that replaces it. The
/// map is a projection along a direction in which neither disk folds over. The border of the disk is
/// unchanged. The composition of the steps maps the mesh one to one onto the coarse mesh. `move` bounds the
/// displacement of points under this map, and thus the distance between the two surfaces in both directions.
/// `turn_rad` bounds the angle between the normals at a point and at its image. All this holds up to
/// rounding.
///
/// Law N5 (topology): closed surfaces stay closed, borders stay as they are, and no two facets get the same
/// three corners.
CoarseMesh coarsened(const FacetMesh& mesh, std::span<const double> most_move, double most_turn_rad);

}  // namespace tubefoot
