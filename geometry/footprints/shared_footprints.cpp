// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/shared_footprints.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <span>

#include "geometry/arithmetic/wide_direction.hpp"
#include "geometry/footprints/corner_rests.hpp"
#include "geometry/footprints/footprint_builder.hpp"
#include "geometry/footprints/plane_lines.hpp"
#include "geometry/footprints/seen_piece.hpp"
#include "geometry/numbers/grid_vector.hpp"
#include "geometry/steps/stop.hpp"

// Finds the facets that both apexes see from the same side and intersects their pieces there. Pieces that
// cover their whole facet need no intersection; the corners of the other piece are copied.

namespace tubefoot {
namespace {

/// Returns whether all corners are finite. Lines that plain double arithmetic takes for neighbours may be
/// parallel.
bool is_finite(std::span<const glm::dvec3> corners) {
  return std::ranges::all_of(corners, [](glm::dvec3 p) { return std::isfinite(p.x + p.y + p.z); });
}

/// Returns by tube the number of rays of all previous tubes.
std::vector<std::uint32_t> first_rays(const ApexLook& look) {
  std::vector<std::uint32_t> first;
  std::size_t rays = 0;
  for (const TubeVisibility& seen : look.seen) {
    first.push_back(static_cast<std::uint32_t>(rays));
    rays += seen.rays.size();
  }
  return first;
}

std::vector<GridPoint> all_rays(const ApexLook& look) {
  std::vector<GridPoint> rays;
  for (const TubeVisibility& seen : look.seen) rays.insert(rays.end(), seen.rays.begin(), seen.rays.end());
  return rays;
}

}  // namespace

SharedFacet facet_between(const FacetCone& from_transmitter, const FacetCone& from_receiver, double unit_m) {
  SharedFacet facet;
  facet.facet = from_transmitter.id;
  const Vec64& n = from_transmitter.normal;
  const glm::dvec3 normal(static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z));
  const double length = glm::length(normal);
  facet.plane_normal = -normal / length;
  facet.transmit_distance_m = static_cast<double>(from_transmitter.offset) / length * unit_m;
  facet.receive_distance_m = static_cast<double>(from_receiver.offset) / length * unit_m;
  return facet;
}

std::vector<FootprintSharer::Seen> FootprintSharer::pieces_of(const ApexLook& look) {
  std::vector<Seen> pieces;
  for (std::uint32_t tube = 0; tube < look.seen.size(); ++tube)
    for (std::uint32_t k = 0; k < look.seen[tube].pieces.size(); ++k)
      pieces.push_back({look.origin_of(look.seen[tube].pieces[k].facet), tube, k});
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const Seen& a, const Seen& b) { return a.facet < b.facet; });
  return pieces;
}

FootprintSharer::FootprintSharer(const FacetMesh& mesh, const ApexLook& transmit, const ApexLook& receive,
                                 double unit_m, SharedDetails details)
    : mesh_(mesh),
      transmit_(transmit),
      receive_(receive),
      unit_m_(unit_m),
      details_(details),
      transmit_pieces_(pieces_of(transmit)),
      receive_pieces_(pieces_of(receive)) {
  find_facets();
  if (!details_.named_edges) return;
  transmit_first_ray_ = first_rays(transmit_);
  receive_first_ray_ = first_rays(receive_);
}

FootprintSharer::FootprintSharer(const ApexLook& transmit, const ApexLook& receive, double unit_m)
    : mesh_(*transmit.mesh),
      images_(true),
      transmit_(transmit),
      receive_(receive),
      unit_m_(unit_m),
      transmit_pieces_(pieces_of(transmit)),
      receive_pieces_(pieces_of(receive)) {
  find_facets();
}

bool FootprintSharer::make_cones(const Both& both, FacetCone& from_transmitter,
                                 FacetCone& from_receiver) const {
  const Seen &sent = transmit_pieces_[both.transmit_first], &received = receive_pieces_[both.receive_first];
  const FacetMesh& other = images_ ? *receive_.mesh : mesh_;
  const FacetId seen = images_ ? transmit_.seen[sent.tube].pieces[sent.piece].facet : both.facet,
                seen_there = images_ ? receive_.seen[received.tube].pieces[received.piece].facet : both.facet;
  return FacetCone::make(mesh_, seen, transmit_.tubes.apex, from_transmitter) &&
         FacetCone::make(other, seen_there, receive_.tubes.apex, from_receiver);
}

void FootprintSharer::find_facets() {
  const auto end_of = [](const std::vector<Seen>& pieces, std::uint32_t first) {
    std::uint32_t end = first;
    while (end < pieces.size() && pieces[end].facet == pieces[first].facet) ++end;
    return end;
  };
  std::uint32_t t = 0, r = 0;
  while (t < transmit_pieces_.size() && r < receive_pieces_.size()) {
    const FacetId facet = transmit_pieces_[t].facet, other = receive_pieces_[r].facet;
    const std::uint32_t t_end = end_of(transmit_pieces_, t), r_end = end_of(receive_pieces_, r);
    if (facet == other) {
      const Both both{facet, t, t_end, r, r_end};
      FacetCone from_transmitter, from_receiver;
      if (make_cones(both, from_transmitter, from_receiver) &&
          from_transmitter.reversed == from_receiver.reversed)
        facets_.push_back(both);
    }
    if (facet <= other) t = t_end;
    if (other <= facet) r = r_end;
  }
}

glm::dvec3 FootprintSharer::receiver_m() const {
  return displacement_m(transmit_.tubes.apex, receive_.tubes.apex, unit_m_);
}

FootprintSharer::OnFacet::OnFacet(const FootprintSharer& sharer, const Both& both)
    : chart((sharer.make_cones(both, from_transmitter, from_receiver), from_transmitter)) {
  const FacetMesh& mesh = sharer.mesh_;
  for (std::uint32_t k = both.transmit_first; k < both.transmit_end; ++k) {
    const Seen& piece = sharer.transmit_pieces_[k];
    sent.emplace_back(mesh, sharer.transmit_, piece.tube, piece.piece, from_transmitter, chart);
  }
  for (std::uint32_t k = both.receive_first; k < both.receive_end; ++k) {
    const Seen& piece = sharer.receive_pieces_[k];
    received.emplace_back(mesh, sharer.receive_, piece.tube, piece.piece, from_receiver, chart,
                          sharer.images_ ? &from_transmitter : nullptr);
  }
}

void FootprintSharer::append(std::size_t number, SharedFootprints& out) const {
  stop_if_wanted();
  const Both& both = facets_[number];
  OnFacet on(*this, both);

  const auto first_piece = static_cast<std::uint32_t>(out.pieces.size());
  const glm::dvec3 baseline = receiver_m();
  LinePolygon polygon;
  for (SeenPiece& s : on.sent) {
    stop_if_wanted();
    for (SeenPiece& h : on.received) {
      if (!images_ && !s.may_meet(h)) continue;
      SharedPiece piece{s.tube(), h.tube(), static_cast<std::uint32_t>(out.corners_m.size()), 0};
      const auto add_edge = [&](bool of_receiver, std::uint32_t k) {
        if (!details_.named_edges) return;
        const SeenPiece& own = of_receiver ? h : s;
        const std::uint32_t next = k + 1 == own.points().size() ? 0 : k + 1,
                            first_ray = (of_receiver ? receive_first_ray_ : transmit_first_ray_)[own.tube()];
        const glm::dvec3 apex_m = of_receiver ? baseline : glm::dvec3(0);
        out.edges.push_back({of_receiver, moved(own.name(k), first_ray), moved(own.name(next), first_ray),
                             own.points()[k] * unit_m_ + apex_m, own.points()[next] * unit_m_ + apex_m});
      };
      const auto add_all_edges = [&](bool of_receiver) {
        const auto edges = static_cast<std::uint32_t>((of_receiver ? h : s).points().size());
        for (std::uint32_t k = 0; k < edges; ++k) add_edge(of_receiver, k);
      };
      const auto add_rest = [&](const BallVector& exact) {
        out.corner_rests_m.push_back(rest_m(exact, unit_m_, out.corners_m.back()));
      };
      if (h.is_whole_facet()) {
        for (std::uint32_t k = 0; k < s.points().size(); ++k) {
          out.corners_m.push_back(s.points()[k] * unit_m_);
          if (details_.corner_rests) add_rest(s.exact_point(k));
        }
        add_all_edges(false);
      } else if (s.is_whole_facet() && !images_) {
        for (std::uint32_t k = 0; k < h.points().size(); ++k) {
          out.corners_m.push_back(h.points()[k] * unit_m_ + baseline);
          if (details_.corner_rests)
            add_rest(moved(h.exact_point(k), transmit_.tubes.apex, receive_.tubes.apex));
        }
        add_all_edges(true);
      } else {
        shared_by(s, h, polygon);
        for (std::size_t k = 0; k < polygon.size(); ++k) {
          const PlaneLine &arriving = *polygon[k == 0 ? polygon.size() - 1 : k - 1], &leaving = *polygon[k];
          const std::optional<std::uint32_t> own = s.corner_between(arriving, leaving);
          out.corners_m.push_back(
              (own ? s.points()[*own] : meeting_point(on.from_transmitter, on.chart, arriving, leaving)) *
              unit_m_);
          if (details_.corner_rests)
            add_rest(own ? s.exact_point(*own)
                         : exact_meeting_point(on.from_transmitter, on.chart, arriving, leaving));
          const std::optional<std::uint32_t> edge = s.edge_of(leaving);
          add_edge(!edge, edge ? *edge : h.edge_of(leaving).value());
        }
      }
      if (!is_finite(std::span(out.corners_m).subspan(piece.first))) out.corners_m.resize(piece.first);
      if (details_.named_edges) out.edges.resize(out.corners_m.size());
      if (details_.corner_rests) out.corner_rests_m.resize(out.corners_m.size());
      piece.count = static_cast<std::uint32_t>(out.corners_m.size()) - piece.first;
      if (piece.count > 0) out.pieces.push_back(piece);
    }
  }
  if (out.pieces.size() == first_piece) return;

  SharedFacet facet = facet_between(on.from_transmitter, on.from_receiver, unit_m_);
  facet.facet = both.facet;
  facet.first_piece = first_piece;
  facet.piece_count = static_cast<std::uint32_t>(out.pieces.size()) - first_piece;
  out.facets.push_back(facet);
}

SharedFootprints FootprintSharer::without_facets() const {
  SharedFootprints shared;
  shared.receiver_m = receiver_m();
  if (!details_.named_edges) return shared;
  shared.transmit_rays = all_rays(transmit_);
  shared.receive_rays = all_rays(receive_);
  return shared;
}

SharedFootprints FootprintSharer::all() const {
  SharedFootprints shared = without_facets();
  for (std::size_t k = 0; k < facets(); ++k) append(k, shared);
  return shared;
}

SharedFootprints shared_with_itself(const FacetMesh& mesh, const ApexLook& look, double unit_m,
                                    SharedDetails details) {
  const FacetMesh& seen_mesh = look.mesh == nullptr ? mesh : *look.mesh;
  std::vector<FootprintSet> sets(look.seen.size());
  for (std::uint32_t tube = 0; tube < sets.size(); ++tube)
    append_footprints(seen_mesh, look.tubes, tube, look.seen[tube], unit_m, sets[tube],
                      details.named_edges || details.corner_rests);
  SharedFootprints shared;
  for (const FootprintSet& set : sets) {
    const auto first_ray = static_cast<std::uint32_t>(shared.transmit_rays.size());
    const NameContext context{seen_mesh, look.tubes.apex, set.name_rays};
    if (details.named_edges)
      shared.transmit_rays.insert(shared.transmit_rays.end(), set.name_rays.begin(), set.name_rays.end());
    for (const Footprint& footprint : set.footprints) {
      FacetCone cone;
      if (details.corner_rests) FacetCone::make(seen_mesh, footprint.facet, look.tubes.apex, cone);
      SharedFacet facet;
      facet.facet = look.origin_of(footprint.facet);
      facet.first_piece = static_cast<std::uint32_t>(shared.pieces.size());
      facet.piece_count = footprint.piece_count;
      facet.plane_normal = footprint.plane_normal;
      facet.transmit_distance_m = facet.receive_distance_m = footprint.plane_distance_m;
      for (std::uint32_t k = 0; k < footprint.piece_count; ++k) {
        const Piece& piece = set.pieces[footprint.first_piece + k];
        shared.pieces.push_back({footprint.tube, footprint.tube,
                                 static_cast<std::uint32_t>(shared.corners_m.size()), piece.count});
        const auto first = set.corners_m.begin() + piece.first;
        shared.corners_m.insert(shared.corners_m.end(), first, first + piece.count);
        for (std::uint32_t c = piece.first; c < piece.first + piece.count && details.corner_rests; ++c)
          shared.corner_rests_m.push_back(
              rest_m(exact_point_on(context, set.corner_names[c], cone), unit_m, set.corners_m[c]));
        for (std::uint32_t c = 0; c < piece.count && details.named_edges; ++c) {
          const std::uint32_t from = piece.first + c, to = piece.first + (c + 1 == piece.count ? 0 : c + 1);
          shared.edges.push_back({false, moved(set.corner_names[from], first_ray),
                                  moved(set.corner_names[to], first_ray), set.corners_m[from],
                                  set.corners_m[to]});
        }
      }
      shared.facets.push_back(facet);
    }
  }
  if (details.named_edges) shared.receive_rays = shared.transmit_rays;
  return shared;
}

SharedFootprints exchanged(SharedFootprints shared) {
  for (SharedFacet& facet : shared.facets) std::swap(facet.transmit_distance_m, facet.receive_distance_m);
  for (SharedPiece& piece : shared.pieces) std::swap(piece.transmit_tube, piece.receive_tube);
  for (std::size_t k = 0; k < shared.corner_rests_m.size(); ++k)
    shared.corner_rests_m[k] += rounding_of_difference(shared.corners_m[k], shared.receiver_m);
  for (glm::dvec3& corner : shared.corners_m) corner -= shared.receiver_m;
  for (SharedEdge& edge : shared.edges) {
    edge.of_receiver = !edge.of_receiver;
    edge.from_m -= shared.receiver_m;
    edge.to_m -= shared.receiver_m;
  }
  std::swap(shared.transmit_rays, shared.receive_rays);
  shared.receiver_m = -shared.receiver_m;
  return shared;
}

void append(SharedFootprints& all, const SharedFootprints& more) {
  const auto first_piece = static_cast<std::uint32_t>(all.pieces.size()),
             first_corner = static_cast<std::uint32_t>(all.corners_m.size());
  for (SharedFacet facet : more.facets) {
    facet.first_piece += first_piece;
    all.facets.push_back(facet);
  }
  for (SharedPiece piece : more.pieces) {
    piece.first += first_corner;
    all.pieces.push_back(piece);
  }
  all.corners_m.insert(all.corners_m.end(), more.corners_m.begin(), more.corners_m.end());
  all.corner_rests_m.insert(all.corner_rests_m.end(), more.corner_rests_m.begin(), more.corner_rests_m.end());
  all.edges.insert(all.edges.end(), more.edges.begin(), more.edges.end());
}

}  // namespace tubefoot
