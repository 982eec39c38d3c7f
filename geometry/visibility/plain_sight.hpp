// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/mesh/facet_mesh.hpp"

// What facets show of each other, as far as a few planes alone tell. docs/visibility.md
namespace tubefoot {

/// Tells of places that lie on facets which of the others are seen whole from there, which not at all, and
/// which ask for a look. A facet hides nothing of what lies on the same side of its plane as the place, and
/// nothing that a plane through the place and one of its edges, or one of the other's, sets apart from it: in
/// a room whose walls face each other nothing hides anything. Signs of integers only.
class PlainSight {
 public:
  /// Bits for each pair of facets are kept, and each facet meets each vertex.
  static constexpr std::size_t most_facets = 4096;

  /// Throws std::length_error for a mesh of more than `most_facets`. The mesh must outlive it.
  explicit PlainSight(const FacetMesh& mesh);

  struct View {
    std::vector<FacetId> whole;      ///< increasing
    std::vector<std::uint8_t> look;  ///< by facet
  };
  /// From `place`, close to facet `on`, of what lies on the same side of that facet's plane.
  /// Law X1 (plain sight): a facet that is seen whole is what every ray to it meets first; one of neither
  /// kind
  ///   shows nothing on that side.
  View seen_from(GridPoint place, FacetId on) const;

 private:
  using Word = std::uint64_t;
  using Bits = std::vector<Word>;
  struct Plane {
    Vec64 normal;
    GridPoint through;
    Int128 side(GridPoint p) const { return dot(normal, p - through); }
  };

  bool lies(const Bits& where, FacetId f, FacetId g) const;

  const FacetMesh& mesh_;
  std::size_t words_;
  std::vector<Plane> planes_;
  /// By facet: before whose planes it lies, or behind, touching them at most.
  Bits before_, behind_;
};

}  // namespace tubefoot
