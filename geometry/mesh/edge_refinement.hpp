// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <stdexcept>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/mesh/part_weights.hpp"
#include "geometry/numbers/world_grid.hpp"

// Refines facets so that the mesh stays conforming, because edges alone determine the cuts. See
// docs/notes/textures.md, "Refinement".
namespace tubefoot {

/// A point of a refinement, by its position in the base mesh. Two facets that share an edge describe its
/// points by different weights. They agree on `at_m` to the last bit and on the weights of the edge's two
/// ends.
struct BasePoint {
  FacetId facet = 0;
  /// Weights of the facet's corners; exact, with the sum 1. If one weight is 0, the point lies on the base
  /// edge opposite to that corner. If two weights are 0, the point is the third corner.
  std::array<double, 3> weight{};
  glm::dvec3 at_m{0};  ///< position before placement
};

/// Decides which edges are cut in half. Implementations must be symmetric in the two ends. For ends on a base
/// edge they must not depend on the facet of the BasePoint. Two facets then cut their common edge in the same
/// way. Several threads call cuts().
///
/// The refinement ends only under a condition. The ball of an edge e has the radius 2 e about its middle. If
/// the rule keeps edge e, it must keep each edge e' < e whose ball lies in that of e. The rule "longer than
/// the smallest edge length required anywhere in the edge's ball" satisfies this condition.
class EdgeRule {
 public:
  virtual ~EdgeRule() = default;
  virtual bool cuts(const BasePoint& a, const BasePoint& b) const = 0;
};

/// Returns the final position of a point of the refinement, in metres. For points of a base edge the position
/// must not depend on the facet of the BasePoint. Several threads call it.
using PlaceOfPoint = std::function<glm::dvec3(const BasePoint&)>;

struct RefinementLimits {
  std::size_t facets = 0x80000000u;  ///< maximum number of facets
  bool weights = false;              ///< whether RefinedMesh::weights are computed
};

/// Thrown before the mesh is built if a rule requires more facets than the limits permit.
struct RefinementTooLarge : std::length_error {
  using std::length_error::length_error;
};

struct RefinedMesh {
  FacetMesh mesh;  ///< sub-facets of a base facet are contiguous; base facets have the requested order
  std::vector<FacetId> parent;  ///< per facet: the base facet of which it is a part
  std::vector<PartWeights>
      weights{};  ///< per facet: its position on the base facet before placement, if requested
};

/// Cuts `facets` of `base` as the rule requires. A facet is cut into 2, 3 or 4 parts according to its cut
/// edges. Its parts are cut again until the rule cuts no edge. An edge that is at most half as long as
/// another edge to be cut is cut later. If the longest edge is cut, the facet therefore lies within the ball
/// of every edge that is cut with it (EdgeRule). Consider a rule that requires a size wherever this ball
/// meets a region. It leaves the same facets in the region as a rule that requires the size everywhere.
///
/// Every point is then placed and snapped to the grid; equal grid points are one vertex. Orientation,
/// materials and components are inherited. Vertices are numbered in the order in which the facets refer to
/// them. The result does not depend on the number of threads, and the parts of a facet do not depend on the
/// other refined facets.
///
/// Throws RefinementTooLarge. Throws std::range_error if an edge would have to be cut more than
/// deepest_refinement times, and GridRangeError if a position is outside of the grid.
///
/// Law D1 (conforming): facets that share an edge share its parts; a closed mesh stays closed.
///
/// Law D2 (filling): the parts of a facet fill it exactly.
///
/// Law D3 (local): a rule that requires a size around a region leaves in it the facets of a rule that
/// requires it everywhere.
///
/// Law D4 (alone): neither threads nor the other facets change a facet's parts.
RefinedMesh refine(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                   const EdgeRule& rule, const PlaceOfPoint& place, const RefinementLimits& limits = {});

/// Returns the number of facets that `refine` would make of one facet if every edge longer than `longest_m`
/// were cut. The facets are counted without being constructed.
std::size_t uniform_count(const FacetMesh& base, FacetId facet, const WorldGrid& grid, double longest_m);

}  // namespace tubefoot
