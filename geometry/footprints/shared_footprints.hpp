// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/footprints/footprint.hpp"
#include "geometry/mesh/facet_cone.hpp"
#include "geometry/tubes/tube.hpp"
#include "geometry/visibility/closure.hpp"
#include "geometry/visibility/visibility.hpp"

// Transmitter and separate receiver: what both see of a facet. docs/bistatic.md
namespace tubefoot {

/// The part of a facet that one tube of the transmitter and one of the receiver both see, or one convex piece
/// of it: corners [first, first + count), turning as the rays of the transmitter's tubes do.
struct SharedPiece {
  std::uint32_t transmit_tube = 0, receive_tube = 0;
  std::uint32_t first = 0, count = 0;
};

/// A facet of which both apexes see the same side.
struct SharedFacet {
  FacetId facet = 0;
  std::uint32_t first_piece = 0, piece_count = 0;
  glm::dvec3 plane_normal{0};                              ///< unit, towards the side where the apexes are
  double transmit_distance_m = 0, receive_distance_m = 0;  ///< of the apexes from the plane
};

/// What two apexes see together. Pieces are ordered by facet, transmit tube and receive tube, and have
/// disjoint interiors.
struct SharedFootprints {
  glm::dvec3 receiver_m{0};  ///< receive apex relative to the transmit apex
  std::vector<SharedFacet> facets;
  std::vector<SharedPiece> pieces;
  std::vector<glm::dvec3> corners_m;  ///< relative to the transmit apex, metres
};

/// The facet itself, without pieces, from its cones of both apexes.
SharedFacet facet_between(const FacetCone& from_transmitter, const FacetCone& from_receiver, double unit_m);

/// What an apex sees: `seen[t]` is see()'s result for tube t; by plain double arithmetic, without its
/// contradictions (contradictions.hpp).
struct ApexLook {
  const TubeSet& tubes;
  std::span<const TubeVisibility> seen;
  /// The mesh that was seen, where that is a part of the sharer's, and by its facets those of the sharer's
  /// mesh (in the order of these) that they are or are cut out of (mirror.hpp).
  const FacetMesh* mesh = nullptr;
  std::span<const FacetId> origin{};

  FacetId origin_of(FacetId facet) const { return origin.empty() ? facet : origin[facet]; }
};

struct ExactPart;
struct FacetChart;
class SeenPiece;

/// What holds of a facet that two apexes see, in rationals.
/// Law S5 (parts): the parts that both see lie in what each of them sees; with what only one of them sees
/// they
///   add up to what that one sees.
struct SharedAudit {
  bool closes = false;
  std::size_t pieces = 0;  ///< that they share
  double defect = 0;       ///< what is missing or too much, as a share of the facet; 0 where the law holds
  /// Of the facet as both apexes have it and the exact share of it that they share: not of how that is cut
  /// up, of facet ids, or of the arithmetic. None where they share nothing.
  TopologyHash hash;
};

/// Intersects the pieces of two apexes on the facets that both see. Which pieces meet, and in what polygon,
/// follows from signs of exact integers alone: contacts without area give nothing, and no part is counted
/// twice. A corner of a cut polygon is the exact one, each coordinate (relative to the transmit apex) off by
/// at most 4 units in its last place. Where one of the two sees the whole facet, the other's corners are
/// handed on; those of the receiver, moved to the transmit apex, are off by 4 units in the last place of
/// their coordinates relative to the receive apex and of the baseline. What plain double arithmetic has seen
/// is named as well, and its polygons are intersected as exactly: it is only as right as what was seen.
/// Law S1 (intersection): the pieces are the intersections of what the two apexes see, in rationals.
/// Law S2 (once): what a receiver's tubes share of a footprint adds up to what the receiver sees of it, and
///   contacts without area give nothing.
/// Law S3 (one apex): an apex shares with itself all that it sees.
/// Law S4 (exchange): transmitter and receiver exchanged share the same parts.
class FootprintSharer {
 public:
  /// The looks and the mesh must outlive it. `unit_m`: metres per grid unit.
  FootprintSharer(const FacetMesh& mesh, const ApexLook& transmit, const ApexLook& receive, double unit_m);
  /// Of looks at two images of the same facets: both have a mesh, and facets of the same origin have the same
  /// vertices, in the same order, wherever each apex sees them. A point of one lies on the other as it lies
  /// between the vertices. What is shared is reported where the transmitter sees it; `receive_distance_m` is
  /// that from the receiver's image. As exact as for one mesh.
  FootprintSharer(const ApexLook& transmit_image, const ApexLook& receive_image, double unit_m);

  /// How many facets both look at the same side of; what they see of them may still be apart.
  std::size_t facets() const { return facets_.size(); }
  /// Appends the shared pieces of the facet of that number, in the order of facet ids. Facets without any are
  /// left out.
  void append(std::size_t number, SharedFootprints& out) const;
  /// All facets.
  SharedFootprints all() const;
  /// The parts of the facet of that number with exact corners (exact_parts.hpp).
  std::vector<ExactPart> exact(std::size_t number) const;
  /// The law of the facet of that number; `label` tells pings apart in the hash.
  SharedAudit audit(std::size_t number, std::uint64_t label) const;

  /// The receive apex relative to the transmit apex.
  glm::dvec3 receiver_m() const;

 private:
  /// A piece of an apex's look.
  struct Seen {
    FacetId facet = 0;  ///< of the sharer's mesh
    std::uint32_t tube = 0, piece = 0;
  };
  struct Both {
    FacetId facet = 0;
    std::uint32_t transmit_first = 0, transmit_end = 0, receive_first = 0, receive_end = 0;
  };
  static std::vector<Seen> pieces_of(const ApexLook& look);

  void find_facets();
  struct OnFacet;  // seen_piece.hpp
  bool make_cones(const Both& both, FacetCone& from_transmitter, FacetCone& from_receiver) const;

  const FacetMesh& mesh_;
  bool images_ = false;
  ApexLook transmit_, receive_;
  double unit_m_;
  std::vector<Seen> transmit_pieces_, receive_pieces_;  ///< by facet, then tube
  std::vector<Both> facets_;
};

/// What an apex shares with itself: all that it sees.
SharedFootprints shared_with_itself(const FacetMesh& mesh, const ApexLook& look, double unit_m);

/// The same with transmitter and receiver exchanged. Pieces stay in their order.
SharedFootprints exchanged(SharedFootprints shared);

/// Appends what is in `more`, as if its facets had been appended one by one.
void append(SharedFootprints& all, const SharedFootprints& more);

}  // namespace tubefoot
