// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "geometry/visibility/exact_direction.hpp"
#include "geometry/visibility/visibility.hpp"

// Corners of what is seen as they lie between the corners of their facet: in rationals, wherever that facet
// lies. Heavy: include only in .cpp files.
namespace tubefoot {

using ExactWeights = std::array<CGAL::Exact_rational, 3>;

/// The point of those weights between three others.
ExactVector between(const ExactWeights& weights, const std::array<ExactVector, 3>& corners);

/// Weights of a piece's corners, in the order of the facet's vertices in the mesh.
std::vector<ExactWeights> exact_weights(const FacetMesh& mesh, GridPoint apex, const TubeVisibility& seen,
                                        const NamedPiece& piece);

/// A part that two apexes see (FootprintSharer), in the order of the facet's vertices in the transmitter's
/// mesh.
struct ExactPart {
  FacetId facet = 0;                 ///< of the sharer's mesh
  std::array<VertexId, 3> vertex{};  ///< of the transmitter's mesh
  std::uint32_t transmit_tube = 0, receive_tube = 0;
  std::vector<ExactWeights> corners;  ///< turning as the transmitter's rays do
};

}  // namespace tubefoot
