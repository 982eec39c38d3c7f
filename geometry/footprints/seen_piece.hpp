// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "geometry/footprints/corner_rests.hpp"
#include "geometry/footprints/piece_walls.hpp"
#include "geometry/footprints/plane_lines.hpp"
#include "geometry/footprints/shared_footprints.hpp"

// Represents a visible piece of a facet by the lines of its edges. Intersects two pieces of one facet
// that are visible from different apexes. A piece is a convex polygon, counter-clockwise as its apex sees it.
// A corner's name is the mesh vertex or the two planes that define the corner (names.hpp). Names show without
// arithmetic which edges of a piece lie on edges of the facet. Lines are exact; points are rounded. This
// header is expensive to compile: include it only in .cpp files.
namespace tubefoot {

/// Returns the edges of the facet on which a corner lies, by name alone. Bit e stands for the edge from
/// vertex e to the next.
inline unsigned edges_of(const CornerName& corner, const std::array<VertexId, 3>& vertex) {
  const auto index = [&](PointId id) {
    return id == no_point ? 3 : int(std::find(vertex.begin(), vertex.end(), id) - vertex.begin());
  };
  const auto edges_at_vertex = [](int i) { return (1u << i) | (1u << ((i + 2) % 3)); };
  if (corner.point != no_point) return index(corner.point) < 3 ? edges_at_vertex(index(corner.point)) : 0;
  unsigned edges = 0;
  for (const PlaneName& plane : {corner.p, corner.q}) {
    if (plane.depth) continue;  // a depth plane contains no edge of the facet by name
    const int i = index(plane.a), j = index(plane.b);
    if (i < 3 && j < 3 && i != j) edges |= edges_at_vertex(i) & edges_at_vertex(j);
  }
  return edges;
}

/// A piece that one of the apexes sees, on its facet.
class SeenPiece {
 public:
  SeenPiece(const FacetMesh& mesh, const ApexLook& look, std::uint32_t tube, std::uint32_t piece,
            const FacetCone& facet, const FacetChart& chart, const FacetCone* charted = nullptr)
      : tube_(tube),
        charted_(charted),
        context_{look.mesh == nullptr ? mesh : *look.mesh, look.tubes.apex, look.seen[tube].rays},
        seen_(&look.seen[tube]),
        piece_(seen_->pieces[piece]),
        facet_(&facet),
        chart_(chart) {
    if (look.mesh != nullptr) {
      // The names are those of the facet that was seen, which may be a part of this facet.
      FacetCone facet_when_seen;
      if (FacetCone::make(*look.mesh, piece_.facet, look.tubes.apex, facet_when_seen) &&
          facet_when_seen.point == facet.point) {
        vertex_ = facet_when_seen.vertex;
      } else {
        vertex_.fill(no_point);  // no corner lies on a facet edge by name, so whole_ becomes false
        is_cut_ = true;
      }
    } else {
      vertex_ = facet.vertex;
    }
    lo_[0] = lo_[1] = std::numeric_limits<double>::infinity();
    hi_[0] = hi_[1] = -lo_[0];
    const glm::dvec3 vertex(facet.point[0].x, facet.point[0].y, facet.point[0].z);
    const int axis[2] = {chart.u, chart.v};
    for (std::uint32_t k = 0; k < piece_.count; ++k) {
      points_.push_back(point_on_facet(context_, corner(k), seen_as(facet)));
      whole_ = whole_ && on_facet_edge(k);
      for (int i = 0; i < 2; ++i) {
        const double x = points_.back()[axis[i]], origin = vertex[axis[i]];
        const double error = 1e-14 * (std::abs(x) + std::abs(origin));
        lo_[i] = std::min(lo_[i], x - origin - error);
        hi_[i] = std::max(hi_[i], x - origin + error);
      }
    }
  }

  std::uint32_t tube() const { return tube_; }
  /// Points relative to the apex, in grid units.
  const std::vector<glm::dvec3>& points() const { return points_; }
  /// Returns true only if every edge lies on an edge of the facet.
  bool is_whole_facet() const { return whole_; }
  /// Returns whether the piece belongs to a cut part of the facet. The rounded corners of such a part may lie
  /// beyond the facet's edges.
  bool is_of_cut_facet() const { return is_cut_; }
  /// Returns false only if the two pieces have no point in common.
  bool may_meet(const SeenPiece& o) const {
    return lo_[0] <= o.hi_[0] && o.lo_[0] <= hi_[0] && lo_[1] <= o.hi_[1] && o.lo_[1] <= hi_[1];
  }
  bool on_facet_edge(std::uint32_t k) const {
    const std::uint32_t next = k + 1 == piece_.count ? 0 : k + 1;
    return (edges_of(corner(k), vertex_) & edges_of(corner(next), vertex_)) != 0;
  }

  /// Returns the lines of the edges; edge k runs from corner k to the next. They are computed at the first
  /// call.
  const std::vector<PlaneLine>& lines() {
    if (!lines_.empty()) return lines_;
    lines_.reserve(piece_.count);
    const auto corners = std::span(seen_->corners).subspan(piece_.first, piece_.count);
    for (std::uint32_t k = 0; k < piece_.count; ++k) {
      const std::array<HugeInt, 3> normal = inward_normal(context_, corners, k, points_);
      lines_.push_back(charted_ == nullptr ? PlaneLine::on_plane(*facet_, chart_, normal)
                                           : PlaneLine::through_image(*facet_, *charted_, chart_, normal));
    }
    return lines_;
  }
  /// Returns the number of the edge with this line, or none if the line is not one of lines(). Compares
  /// addresses, so `lines_` must not move between calls.
  std::optional<std::uint32_t> edge_of(const PlaneLine& line) const {
    const std::less<const PlaneLine*> before;
    if (lines_.empty() || before(&line, &lines_.front()) || before(&lines_.back(), &line))
      return std::nullopt;
    return static_cast<std::uint32_t>(&line - lines_.data());
  }
  /// Returns the corner of this piece at which `arriving` turns into `leaving`, or none if these are not
  /// successive lines of the piece.
  std::optional<std::uint32_t> corner_between(const PlaneLine& arriving, const PlaneLine& leaving) const {
    const std::optional<std::uint32_t> first = edge_of(arriving), second = edge_of(leaving);
    if (!first || !second || *first != (*second == 0 ? lines_.size() : *second) - 1) return std::nullopt;
    return second;
  }
  /// Encloses a corner relative to the apex, in grid units.
  BallVector exact_point(std::uint32_t k) const { return exact_point_on(context_, corner(k), *facet_); }
  /// Returns the name of a corner, with rays of its own tube.
  const CornerName& name(std::uint32_t k) const { return corner(k); }
  const LinePolygon& polygon() {
    if (!polygon_made_) polygon_ = line_polygon(lines());
    polygon_made_ = true;
    return polygon_;
  }

 private:
  /// Returns the facet with the names that it had when it was seen.
  FacetCone seen_as(FacetCone facet) const {
    facet.vertex = vertex_;
    return facet;
  }
  const CornerName& corner(std::uint32_t k) const { return seen_->corners[piece_.first + k]; }

  std::uint32_t tube_;
  const FacetCone* charted_;  // the facet of which this facet is an image; null: the facet itself
  NameContext context_;
  const TubeVisibility* seen_;
  NamedPiece piece_;
  const FacetCone* facet_;
  std::array<VertexId, 3> vertex_{};  // names of its vertices
  FacetChart chart_;
  std::vector<glm::dvec3> points_;
  double lo_[2], hi_[2];  // ranges of u and v, including their errors
  bool whole_ = true, polygon_made_ = false, is_cut_ = false;
  std::vector<PlaneLine> lines_;
  LinePolygon polygon_;
};

/// Computes the intersection of two pieces of a facet; empty if there is none.
inline void shared_by(SeenPiece& sent, SeenPiece& received, LinePolygon& polygon) {
  thread_local std::vector<int> sides;
  const auto clip_by = [&](SeenPiece& other, bool including_facet_edges) {
    const auto& lines = other.lines();
    for (std::uint32_t k = 0; k < lines.size() && !polygon.empty(); ++k)
      if (!lines[k].is_none() && (including_facet_edges || !other.on_facet_edge(k)))
        clip(polygon, lines[k], sides);
  };
  // A visible piece lies on its facet, so the facet's own edges cut nothing off. Pieces of a part that a
  // mirror has cut are an exception. Such a piece is never the whole facet.
  if (sent.is_whole_facet() && !received.is_whole_facet()) {
    polygon = received.polygon();
    if (received.is_of_cut_facet()) clip_by(sent, true);
    return;
  }
  polygon = sent.polygon();
  if (sent.is_of_cut_facet() || !received.is_whole_facet()) clip_by(received, sent.is_of_cut_facet());
}

/// The cones of one facet from both apexes, and the pieces of it that each apex sees. The pieces refer to the
/// cones stored here.
struct FootprintSharer::OnFacet {
  FacetCone from_transmitter, from_receiver;
  FacetChart chart;
  std::vector<SeenPiece> sent, received;

  OnFacet(const FootprintSharer& sharer, const Both& both);
  OnFacet(const OnFacet&) = delete;
  OnFacet& operator=(const OnFacet&) = delete;
};

}  // namespace tubefoot
