// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/contradictions.hpp"

#include <vector>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/arithmetic/wide_direction.hpp"

namespace tubefoot {

void leave_out_contradictions(const FacetMesh& mesh, GridPoint apex, TubeVisibility& seen) {
  const NameContext context{mesh, apex, seen.rays};
  const auto keep_what_is_in_front = [&](NamedPiece& piece, const WideVec& axis) {
    std::uint32_t kept = 0;
    for (std::uint32_t k = 0; k < piece.count; ++k) {
      const CornerName corner = seen.corners[piece.first + k];
      if (dot(wide_direction(context, corner), axis) > 0) seen.corners[piece.first + kept++] = corner;
    }
    piece.count = kept;
  };
  for (NamedPiece& piece : seen.pieces)
    if (FacetCone cone; FacetCone::make(mesh, piece.facet, apex, cone))
      keep_what_is_in_front(piece, widen(cone.normal));
    else
      piece.count = 0;
  WideVec middle;
  for (std::size_t k = 0; k < 4; ++k) {
    middle[0] += seen.rays[k].x;
    middle[1] += seen.rays[k].y;
    middle[2] += seen.rays[k].z;
  }
  for (NamedPiece& piece : seen.open) keep_what_is_in_front(piece, middle);
  for (auto* pieces : {&seen.pieces, &seen.open})
    std::erase_if(*pieces, [](const NamedPiece& piece) { return piece.count < 3; });
}

}  // namespace tubefoot
