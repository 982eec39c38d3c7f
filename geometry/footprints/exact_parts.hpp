// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "geometry/visibility/exact_direction.hpp"
#include "geometry/visibility/visibility.hpp"

// Corners of visible polygons as rational weights of the corners of their facet. The weights do not depend on
// the facet's position. This header is expensive to compile: include it only in .cpp files.
namespace tubefoot {

using ExactWeights = std::array<CGAL::Exact_rational, 3>;

/// Returns the point with these weights between three corners.
ExactVector between(const ExactWeights& weights, const std::array<ExactVector, 3>& corners);

/// Returns the weights of a piece's corners, in the order of the facet's vertices in the mesh.
std::vector<ExactWeights> exact_weights(const FacetMesh& mesh, GridPoint apex, const TubeVisibility& seen,
                                        const NamedPiece& piece);

/// A part that two apexes see (FootprintSharer). Its weights follow the order of the facet's vertices in the
/// transmitter's mesh.
struct ExactPart {
  FacetId facet = 0;                 ///< facet of the sharer's mesh
  std::array<VertexId, 3> vertex{};  ///< vertices in the transmitter's mesh
  std::uint32_t transmit_tube = 0, receive_tube = 0;
  std::vector<ExactWeights> corners;  ///< in the sense of rotation of the transmitter's rays
};

}  // namespace tubefoot
