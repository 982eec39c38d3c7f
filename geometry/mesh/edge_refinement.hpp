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

// Refinement of facets that stays conforming because edges alone decide it. docs/textures.md, "Refinement"
namespace tubefoot {

/// A point of a refinement: where it lies in the mesh that is refined. Two facets that share an edge name its
/// points by different weights, but agree on `at_m` to the last bit, and on the weights of the edge's two
/// ends.
struct BasePoint {
  FacetId facet = 0;
  /// Of the facet's corners; exact, adding up to 1. A corner of weight 0: the point lies on the base edge
  /// opposite to it; two such: it is the third corner.
  std::array<double, 3> weight{};
  glm::dvec3 at_m{0};  ///< before it is placed
};

/// Which edges are cut in half. Symmetric in the two ends, and for ends on a base edge independent of the
/// facet they are named in: facets that share an edge then cut it alike without knowing of each other. Called
/// from several threads. So that cutting ends, an edge that it leaves whole must not lie beside shorter ones
/// that it cuts again and again: if it leaves edge e, it must leave each edge e' < e whose ball of radius 2
/// e' about its middle lies in the like ball of e. "Longer than what is wanted anywhere in the edge's ball"
/// is such a rule.
class EdgeRule {
 public:
  virtual ~EdgeRule() = default;
  virtual bool cuts(const BasePoint& a, const BasePoint& b) const = 0;
};

/// Where a point of the refinement is put, metres; for points of a base edge independent of the facet they
/// are named in. Called from several threads.
using PlaceOfPoint = std::function<glm::dvec3(const BasePoint&)>;

struct RefinementLimits {
  std::size_t facets = 0x80000000u;  ///< no more than these are made
  bool weights = false;              ///< whether RefinedMesh::weights are wanted
};

/// Thrown, before the mesh is built, where a rule wants more than the limits.
struct RefinementTooLarge : std::length_error {
  using std::length_error::length_error;
};

struct RefinedMesh {
  FacetMesh mesh;  ///< sub-facets of a base facet follow one another, base facets in the order asked for
  std::vector<FacetId> parent;         ///< by facet: the base facet it is part of
  std::vector<PartWeights> weights{};  ///< by facet: where it lies on that, before it is placed; if wanted
};

/// Cuts `facets` of `base` as the rule says: a facet is cut by which of its edges are (into 2, 3 or 4), its
/// parts again, until no edge is to be cut. An edge that is at most half as long as another that is to be cut
/// waits for it: if the longest edge is cut, the facet thus lies within the ball of every edge that is cut
/// with it (radius twice its length, about its middle). A rule that asks for a size wherever that ball meets
/// a region therefore leaves the same facets in the region as one that asks for it everywhere. Every point is
/// then placed and snapped; equal grid points are one vertex. Orientation, materials and components are
/// carried over; vertices are numbered as the facets name them. The result does not depend on the number of
/// threads, and the parts of a facet do not depend on which other facets are refined. Throws
/// RefinementTooLarge; std::range_error where an edge would have to be cut more than deepest_refinement
/// times; GridRangeError where a place does not fit the grid.
/// Law D1 (conforming): facets that share an edge share its parts; a closed mesh stays closed.
/// Law D2 (filling): the parts of a facet fill it exactly.
/// Law D3 (local): a rule that asks for a size about a region leaves in it the facets of one that asks for it
///   everywhere.
/// Law D4 (alone): neither threads nor the other facets change a facet's parts.
RefinedMesh refine(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                   const EdgeRule& rule, const PlaceOfPoint& place, const RefinementLimits& limits = {});

/// How many facets `refine` would make of one facet if every edge longer than `longest_m` were cut: counted,
/// not made.
std::size_t uniform_count(const FacetMesh& base, FacetId facet, const WorldGrid& grid, double longest_m);

}  // namespace tubefoot
