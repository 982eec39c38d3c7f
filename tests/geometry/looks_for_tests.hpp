// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <map>

#include "geometry/visibility/closure.hpp"
#include "geometry/visibility/exact_direction.hpp"
#include "geometry/visibility/visibility.hpp"

// The kernel as tests of its laws use it: all tubes of a ping at once, and areas per facet.
namespace tubefoot::test {

inline VisibilityOptions with(Arithmetic arithmetic, std::uint32_t facets_per_split = 24) {
  VisibilityOptions options;
  options.arithmetic = arithmetic;
  options.facets_per_split = facets_per_split;
  options.open_water = true;
  return options;
}

/// What a whole ping sees, in one hash, and whether every tube closes.
struct Look {
  TopologyHash hash;
  std::size_t not_closed = 0, pieces = 0;
};

inline Look look(const FacetMesh& mesh, const TubeSet& tubes,
                 const VisibilityOptions& options = with(Arithmetic::fixed)) {
  const SceneTree tree(mesh);
  VisibilityScratch scratch;
  TubeVisibility seen;
  Look result;
  for (std::uint32_t t = 0; t < tubes.tubes.size(); ++t) {
    see(mesh, tree, tubes, t, options, scratch, seen);
    const TubeAudit checked = audit(mesh, tubes, t, seen, t);
    result.hash += checked.hash;
    result.not_closed += !checked.closes;
    result.pieces += checked.pieces;
  }
  return result;
}

/// Per facet: exact gnomonic area of what tube `tube` sees of it, in the plane axis . x = 1.
using Areas = std::map<FacetId, CGAL::Exact_rational>;

inline void add_areas(Areas& areas, const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes,
                      std::uint32_t tube, const ExactVector& axis, VisibilityScratch& scratch) {
  TubeVisibility seen;
  see(mesh, tree, tubes, tube, with(Arithmetic::fixed), scratch, seen);
  const NameContext context{mesh, tubes.apex, seen.rays};
  for (const NamedPiece& piece : seen.pieces)
    areas[piece.facet] += gnomonic_area(axis, exact_directions(context, seen.corners, piece));
}

/// One entry per tube, each in the tube's own plane.
inline std::vector<Areas> areas_of(const FacetMesh& mesh, const TubeSet& tubes) {
  const SceneTree tree(mesh);
  VisibilityScratch scratch;
  std::vector<Areas> areas(tubes.tubes.size());
  for (std::uint32_t t = 0; t < areas.size(); ++t)
    add_areas(areas[t], mesh, tree, tubes, t, gnomonic_axis(tubes, t), scratch);
  return areas;
}

}  // namespace tubefoot::test
