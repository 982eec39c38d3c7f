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

// Computes the common visibility of a transmitter and a separate receiver: the part of each facet that both
// see. The visible polygons of both apexes are intersected on the facet in exact arithmetic
// (docs/notes/bistatic.md).
namespace tubefoot {

/// The part of a facet that one tube of the transmitter and one tube of the receiver both see, or a convex
/// piece of it. Its corners are [first, first + count), in the sense of rotation of the rays of the
/// transmitter's tubes.
struct SharedPiece {
  std::uint32_t transmit_tube = 0, receive_tube = 0;
  std::uint32_t first = 0, count = 0;
};

/// A facet of which both apexes see the same side.
struct SharedFacet {
  FacetId facet = 0;
  std::uint32_t first_piece = 0, piece_count = 0;
  glm::dvec3 plane_normal{0};                              ///< unit normal towards the apexes
  double transmit_distance_m = 0, receive_distance_m = 0;  ///< distances of the apexes from the plane
};

/// The edge of a visible piece of one apex that contains an edge of a shared piece. The corners of this edge
/// have names, from which its motion follows.
struct SharedEdge {
  bool of_receiver = false;  ///< of the receive apex, to which the names then refer
  CornerName from, to;
  glm::dvec3 from_m{0}, to_m{0};  ///< relative to the transmit apex
};

/// Optional contents of SharedFootprints.
struct SharedDetails {
  bool named_edges = false;   ///< SharedFootprints::edges
  bool corner_rests = false;  ///< SharedFootprints::corner_rests_m
};

/// The common visibility of two apexes. Pieces are ordered by facet, transmit tube and receive tube, and have
/// disjoint interiors.
struct SharedFootprints {
  glm::dvec3 receiver_m{0};  ///< receive apex relative to the transmit apex
  std::vector<SharedFacet> facets;
  std::vector<SharedPiece> pieces;
  std::vector<glm::dvec3> corners_m;  ///< relative to the transmit apex, metres
  /// By corner: the exact corner minus its rounded position in corners_m. The sum is accurate to
  /// corner_rest_error times the size of the coordinates. Empty unless SharedDetails requests it.
  std::vector<glm::dvec3> corner_rests_m{};
  /// Edge k starts at corner k. Empty unless SharedDetails requests it.
  std::vector<SharedEdge> edges{};
  /// The rays to which the names of edges refer, as FootprintSet::name_rays.
  std::vector<GridPoint> transmit_rays{}, receive_rays{};
};

/// Relative error of a corner with its rest. The reference is the distance of the corner from the apex of its
/// piece, plus the distance between the apexes.
///
/// Law S6 (rests): the exact corner lies within this error of the sum of corner and rest.
constexpr double corner_rest_error = 0x1p-98;

/// Returns the facet itself, without pieces, from its cones of both apexes.
SharedFacet facet_between(const FacetCone& from_transmitter, const FacetCone& from_receiver, double unit_m);

/// The visible polygons of an apex. `seen[t]` is the result of see() for tube t. With plain double arithmetic
/// the contradictory pieces are omitted (contradictions.hpp).
struct ApexLook {
  const TubeSet& tubes;
  std::span<const TubeVisibility> seen;
  /// The mesh that the apex sees, if it is a part of the sharer's mesh. `origin` has, per facet of this mesh,
  /// the facet of the sharer's mesh that it is or from which it is cut (mirror.hpp). The order of `origin` is
  /// that of the facets of this mesh.
  const FacetMesh* mesh = nullptr;
  std::span<const FacetId> origin{};

  FacetId origin_of(FacetId facet) const { return origin.empty() ? facet : origin[facet]; }
};

struct ExactPart;
struct FacetChart;
class SeenPiece;

/// The result of checking a facet that two apexes see, in rationals.
///
/// Law S5 (parts): the parts that both apexes see lie inside the visible polygons of each. Together with the
/// parts that only one apex sees, they add up to all that this apex sees.
struct SharedAudit {
  bool closes = false;
  std::size_t pieces = 0;  ///< number of pieces that both share
  double defect = 0;       ///< missing or surplus area, as a share of the facet; 0 if the law holds
  /// Hash of the facet as both apexes have it and of the exact share that both see. It does not depend on the
  /// division into pieces, on facet ids or on the arithmetic. None if they share nothing.
  TopologyHash hash;
};

/// Intersects the pieces of two apexes on the facets that both see. Signs of exact integers alone determine
/// which pieces meet and in which polygon. Contacts without area give nothing, and no part counts twice.
///
/// A corner of a cut polygon is exact. Each of its coordinates relative to the transmit apex is rounded to at
/// most 4 units in its last place. If one apex sees the whole facet, the corners of the other apex's piece
/// are copied. Corners of the receiver are moved to the transmit apex. Their error is 4 units in the last
/// place of their coordinates relative to the receive apex and of the baseline.
///
/// Pieces of plain double arithmetic have names too, and their polygons are intersected equally exactly. The
/// result is then only as correct as these pieces are.
///
/// Law S1 (intersection): the pieces are the intersections of the visible polygons of the two apexes, in
/// rationals.
///
/// Law S2 (once): the parts of a footprint that a receiver's tubes share add up to the part of the footprint
/// that the receiver sees. Contacts without area give nothing.
///
/// Law S3 (one apex): an apex shares with itself all that it sees.
///
/// Law S4 (exchange): an exchange of transmitter and receiver gives the same parts.
class FootprintSharer {
 public:
  /// The looks and the mesh must outlive the object. `unit_m` is the grid unit in metres.
  FootprintSharer(const FacetMesh& mesh, const ApexLook& transmit, const ApexLook& receive, double unit_m,
                  SharedDetails details = {});
  /// Constructs the intersection for two images of the same facets. Both looks have a mesh. Facets of the
  /// same origin have the same vertices in the same order, at any position of each image. A point of one
  /// image corresponds to the point of the other that lies in the same way between the vertices. The shared
  /// parts are reported at the positions of the transmitter's image. `receive_distance_m` is the distance in
  /// the receiver's image. The result is as exact as for one mesh.
  FootprintSharer(const ApexLook& transmit_image, const ApexLook& receive_image, double unit_m);

  /// Returns the number of facets of which both see the same side. The visible polygons of such a facet may
  /// still be disjoint.
  std::size_t facets() const { return facets_.size(); }
  /// Appends the shared pieces of the facet of that number, in the order of facet ids. Facets without shared
  /// pieces are omitted.
  void append(std::size_t number, SharedFootprints& out) const;
  /// Returns the shared pieces of all facets.
  SharedFootprints all() const;
  /// Returns the result of all() before the first facet is appended.
  SharedFootprints without_facets() const;
  /// Returns the shared parts of the facet of that number with exact corners (exact_parts.hpp).
  std::vector<ExactPart> exact(std::size_t number) const;
  /// Checks the law for the facet of that number. `label` distinguishes pings in the hash.
  SharedAudit audit(std::size_t number, std::uint64_t label) const;

  /// Returns the receive apex relative to the transmit apex.
  glm::dvec3 receiver_m() const;

 private:
  /// A piece that an apex sees.
  struct Seen {
    FacetId facet = 0;  ///< facet of the sharer's mesh
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
  SharedDetails details_;
  std::vector<Seen> transmit_pieces_, receive_pieces_;                 ///< by facet, then tube
  std::vector<std::uint32_t> transmit_first_ray_, receive_first_ray_;  ///< by tube, for names of edges
  std::vector<Both> facets_;
};

/// Returns the common visibility of an apex with itself: all that it sees.
SharedFootprints shared_with_itself(const FacetMesh& mesh, const ApexLook& look, double unit_m,
                                    SharedDetails details = {});

/// Exchanges transmitter and receiver. Pieces keep their order.
SharedFootprints exchanged(SharedFootprints shared);

/// Appends the facets of `more`, with the same result as if they had been appended one by one.
void append(SharedFootprints& all, const SharedFootprints& more);

}  // namespace tubefoot
