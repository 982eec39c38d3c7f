// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/shadow_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include "geometry/footprints/piece_walls.hpp"

// Finds the edges that cast shadow borders by the names of corners, as shadow_borders() does. Two corners of
// a footprint are the ends of a border if they share the plane of another facet's edge in front of it.

namespace tubefoot {
namespace {

constexpr double share_rounding = 1e-9;

/// An edge by its vertices, and the side of its plane that is hidden.
using EdgeName = std::tuple<VertexId, VertexId, bool>;

/// A part of an edge, as shares of its length, with the facets at the border. `low_open`, `high_open`:
/// whether the wall of a tube ends it.
struct EdgePart {
  double low, high;
  FacetId facet, background;
  bool low_open, high_open;
};

/// Returns whether a corner lies on a wall of its tube.
bool is_at_wall(const CornerName& corner) {
  if (corner.point != no_point) return (corner.point & ray_bit) != 0;
  const auto is_wall = [](const PlaneName& plane) {
    return !plane.depth && ((plane.a | plane.b) & ray_bit) != 0;
  };
  return is_wall(corner.p) || is_wall(corner.q);
}

bool has_vertex(const std::array<VertexId, 3>& facet, VertexId vertex) {
  return std::ranges::find(facet, vertex) != facet.end();
}

/// Line of an edge, for rays from the apex.
struct EdgeLine {
  glm::dvec3 a, b, normal;
  double slope(glm::dvec3 p) const { return glm::dot(glm::cross(b - a, p), normal); }
  /// The ray to p meets the line at a + share (b - a).
  double share(glm::dvec3 p) const { return -glm::dot(glm::cross(a, p), normal) / slope(p); }
  glm::dvec3 at(double share) const { return a + share * (b - a); }
};

class EdgeFinder {
 public:
  EdgeFinder(const FacetMesh& mesh, const History& history) : mesh_(mesh), history_(history) {}

  std::map<EdgeName, std::vector<EdgePart>> find() {
    const FootprintSet& set = history_.footprints;
    for (const Footprint& footprint : set.footprints)
      for (std::uint32_t k = 0; k < footprint.piece_count; ++k)
        add(footprint, set.pieces[footprint.first_piece + k]);
    return std::move(parts_);
  }
  EdgeLine line(VertexId a, VertexId b) const {
    const glm::dvec3 from = place(a), to = place(b);
    return {from, to, glm::cross(from, to)};
  }

 private:
  glm::dvec3 place(VertexId vertex) const {
    const GridPoint p = mesh_.vertices[vertex] - history_.tubes.apex;
    return history_.grid_unit_m * glm::dvec3(p.x, p.y, p.z);
  }

  void add(const Footprint& footprint, const Piece& piece) {
    const FootprintSet& set = history_.footprints;
    const std::array<VertexId, 3>& own = mesh_.facets[footprint.facet];
    glm::dvec3 middle(0);
    for (std::uint32_t k = 0; k < piece.count; ++k) middle += set.corners_m[piece.first + k];
    for (std::uint32_t k = 0; k < piece.count; ++k) {
      const std::uint32_t next = (k + 1) % piece.count;
      const CornerName &begin_name = set.corner_names[piece.first + k],
                       &end_name = set.corner_names[piece.first + next];
      const auto plane = shared_plane(begin_name, end_name);
      if (!plane || plane->depth || ((plane->a | plane->b) & ray_bit)) continue;
      if (has_vertex(own, plane->a) && has_vertex(own, plane->b)) continue;
      const auto occluders =
          std::span(set.occluders).subspan(footprint.first_occluder, footprint.occluder_count);
      const auto occluder = std::ranges::find_if(occluders, [&](FacetId f) {
        return has_vertex(mesh_.facets[f], plane->a) && has_vertex(mesh_.facets[f], plane->b);
      });
      if (occluder == occluders.end()) continue;
      const EdgeLine line = this->line(plane->a, plane->b);
      const EdgeName name{plane->a, plane->b, glm::dot(line.normal, middle) < 0};
      const glm::dvec3 begin = set.corners_m[piece.first + k], end = set.corners_m[piece.first + next];
      const auto add_part = [&](glm::dvec3 from, glm::dvec3 to) {
        // Beyond the ends of the edge, its plane only divides pieces.
        double low = std::clamp(line.share(from), 0.0, 1.0), high = std::clamp(line.share(to), 0.0, 1.0);
        bool low_open = is_at_wall(begin_name), high_open = is_at_wall(end_name);
        if (low > high) {
          std::swap(low, high);
          std::swap(low_open, high_open);
        }
        if (!(high - low > share_rounding)) return;
        const glm::dvec3 centre = (from + to) / 2.0;
        if (!(glm::length(line.at(line.share(centre))) < glm::length(centre) * (1 - share_rounding))) return;
        parts_[name].push_back({low, high, *occluder, footprint.facet, low_open, high_open});
      };
      const double first = line.slope(begin), last = line.slope(end);
      if (first * last > 0) {
        add_part(begin, end);
        continue;
      }
      // A ray between them is parallel to the edge.
      const double parallel = first / (first - last);
      if (parallel > share_rounding) add_part(begin, begin + (parallel - share_rounding) * (end - begin));
      if (parallel < 1 - share_rounding) add_part(begin + (parallel + share_rounding) * (end - begin), end);
    }
  }

  const FacetMesh& mesh_;
  const History& history_;
  std::map<EdgeName, std::vector<EdgePart>> parts_;
};

}  // namespace

double ShadowEdge::scale_m(double wavelength_m, double q, double t) const {
  return std::sqrt(wavelength_m * (q - distance_m) * std::sqrt(q * q + t * t) / (2 * distance_m));
}

std::vector<ShadowEdge> shadow_edges(const FacetMesh& mesh, const History& history) {
  constexpr double touching = 1e-6;
  EdgeFinder finder(mesh, history);
  std::vector<ShadowEdge> edges;
  for (auto& [name, parts] : finder.find()) {
    const auto& [a, b, is_positive] = name;
    const EdgeLine line = finder.line(a, b);
    std::ranges::sort(parts, {}, [](const EdgePart& p) { return std::tuple(p.low, p.high, p.background); });
    for (std::size_t k = 0; k < parts.size();) {
      const EdgePart& first = parts[k];
      double high = first.high;
      bool high_open = first.high_open;
      const std::uint16_t background = mesh.component[first.background];
      for (++k; k < parts.size() && parts[k].low < high + touching &&
                mesh.component[parts[k].background] == background;
           ++k) {
        if (parts[k].high <= high) continue;
        high = parts[k].high;
        high_open = parts[k].high_open;
      }
      ShadowEdge edge;
      edge.facet = first.facet;
      edge.component = mesh.component[first.facet];
      edge.background = first.background;
      edge.background_component = background;
      edge.first_m = line.at(first.low);
      edge.last_m = line.at(high);
      edge.normal = (is_positive ? 1.0 : -1.0) * glm::normalize(line.normal);
      edge.along = glm::normalize(line.b - line.a);
      edge.across = glm::cross(edge.normal, edge.along);
      if (glm::dot(edge.across, line.a) < 0) edge.across = -edge.across;
      edge.distance_m = glm::dot(edge.across, (edge.first_m + edge.last_m) / 2.0);
      const double length = glm::distance(line.a, line.b);
      if (first.low_open) edge.before_m = first.low * length;
      if (high_open) edge.beyond_m = (1 - high) * length;
      edges.push_back(edge);
    }
  }
  std::ranges::stable_sort(edges, {}, &ShadowEdge::component);
  return edges;
}

}  // namespace tubefoot
