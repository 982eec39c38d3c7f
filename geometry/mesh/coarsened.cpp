// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/coarsened.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <queue>

#include "geometry/mesh/vertex_star.hpp"
#include "geometry/steps/steps.hpp"
#include "geometry/steps/stop.hpp"

// Removes vertices by edge collapses in the order of their cost, from a priority queue. Each facet carries
// bounds on the displacements and the normals of the surface that it replaces (VertexStar, FacetPast). See
// docs/notes/visibility.md.

namespace tubefoot {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

glm::dvec3 between(GridPoint from, GridPoint to) {
  return {static_cast<double>(to.x) - from.x, static_cast<double>(to.y) - from.y,
          static_cast<double>(to.z) - from.z};
}

/// Removes vertices until no further one may be removed.
class Coarsener {
 public:
  Coarsener(const FacetMesh& mesh, std::span<const double> most_move, double most_turn_rad)
      : mesh_(mesh),
        most_move_(most_move),
        most_turn_(2 * std::sin(std::min(most_turn_rad, 3.0) / 2)),
        facets_(mesh.facets),
        from_(facets_.size()) {
    for (FacetId f = 0; f < facets_.size(); ++f) past_.push_back(first_past(f));
    choose_directions();
    first_corner_.assign(mesh.vertices.size(), none);
    next_corner_.assign(3 * facets_.size(), none);
    for (auto corner = static_cast<std::uint32_t>(3 * facets_.size()); corner-- > 0;) link(corner);
  }

  CoarseMesh coarse() {
    stamps_.assign(mesh_.vertices.size(), 0);
    for (VertexId v = 0; v < mesh_.vertices.size(); ++v) {
      if (v % 1024 == 0) stop_if_wanted();
      consider(v);
    }
    std::size_t seen = 0;
    while (!waiting_.empty()) {
      if (++seen % 16 == 0) stop_if_wanted();
      const Waiting next = waiting_.top();
      waiting_.pop();
      if (next.stamp == stamps_[next.vertex]) take_away(next.vertex);
    }
    return result();
  }

 private:
  struct Waiting {
    float cost;
    VertexId vertex;
    std::uint32_t stamp;
    bool operator<(const Waiting& other) const {  // the cheapest on top
      return cost != other.cost ? cost > other.cost : vertex > other.vertex;
    }
  };
  using Ring = std::array<std::uint32_t, VertexStar::most_facets>;

  glm::dvec3 area_of(const std::array<VertexId, 3>& facet) const {
    const GridPoint a = mesh_.vertices[facet[0]];
    return glm::cross(between(a, mesh_.vertices[facet[1]]), between(a, mesh_.vertices[facet[2]]));
  }

  FacetPast first_past(FacetId f) const {
    FacetPast past;
    past.moves = VectorBox::of(glm::dvec3(0));
    const glm::dvec3 area = area_of(mesh_.facets[f]);
    const double length = glm::length(area);
    if (length > 0 && most_move_[f] > 0) {  // otherwise the facet is never changed
      past.normals = VectorBox::of(area / length);
      past.limit = static_cast<float>(most_move_[f] * (1 - 1e-6));
    }
    return past;
  }

  /// Chooses up or down for components all of whose facets face that way, otherwise the axis to which a
  /// facet's normal is closest.
  void choose_directions() {
    direction_.resize(facets_.size());
    std::vector<std::array<bool, 2>> level;  // per component: all facets face up; all face down
    for (std::size_t f = 0; f < facets_.size(); ++f) {
      const std::size_t component = mesh_.component[f];
      if (component >= level.size()) level.resize(component + 1, {true, true});
      const double z = area_of(facets_[f]).z;
      level[component][0] = level[component][0] && z > 0;
      level[component][1] = level[component][1] && z < 0;
    }
    for (std::size_t f = 0; f < facets_.size(); ++f) {
      const glm::dvec3 area = area_of(facets_[f]), size = glm::abs(area);
      int axis = size.y > size.x ? 1 : 0;
      if (size.z > size[axis]) axis = 2;
      const auto& [up, down] = level[mesh_.component[f]];
      if (up || down) axis = 2;
      direction_[f] = static_cast<std::int8_t>(area[axis] > 0 ? axis : axis + 3);
    }
  }

  /// Adds the pieces of the star. If all facets have one direction, the displacement is measured along it
  /// from the original positions. If facets of several directions meet, the displacement is measured from the
  /// current positions, and the bounds on displacements add up.
  bool look(VertexId v, const Ring& corners, VertexStar& star, std::vector<FacetId>& pieces) const {
    const int direction = direction_[corners[0] / 3];
    bool is_one = direction >= 0;
    for (unsigned i = 1; i < star.facets; ++i) is_one = is_one && direction_[corners[i] / 3] == direction;
    pieces.clear();
    if (!is_one) {
      if (!star.look({})) return false;
      star.add_own_pieces();
      return true;
    }
    glm::dvec3 along(0);
    along[direction % 3] = direction < 3 ? 1 : -1;
    if (!star.look(along)) return false;
    for (unsigned i = 0; i < star.facets; ++i) {
      const FacetId facet = corners[i] / 3;
      if (from_[facet].empty()) pieces.push_back(facet);
      pieces.insert(pieces.end(), from_[facet].begin(), from_[facet].end());
    }
    std::ranges::sort(pieces);
    pieces.erase(std::unique(pieces.begin(), pieces.end()), pieces.end());
    for (const FacetId piece : pieces) {
      std::array<glm::dvec3, 3> at;
      for (std::size_t k = 0; k < 3; ++k)
        at[k] = between(mesh_.vertices[v], mesh_.vertices[mesh_.facets[piece][k]]);
      star.add_piece(at, first_past(piece));
    }
    return true;
  }

  VertexId at(std::uint32_t corner) const { return facets_[corner / 3][corner % 3]; }
  static std::uint32_t onward(std::uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

  void link(std::uint32_t corner) {
    std::uint32_t& first = first_corner_[at(corner)];
    next_corner_[corner] = first;
    first = corner;
  }
  void unlink(std::uint32_t corner) {
    std::uint32_t* to = &first_corner_[at(corner)];
    while (*to != corner) to = &next_corner_[*to];
    *to = next_corner_[corner];
  }

  /// Returns whether the facets of a vertex form a disk of one component and material that may be changed. If
  /// so, computes the star and, per facet, the corner at the vertex.
  bool gather(VertexId v, VertexStar& star, Ring& corners) const {
    unsigned count = 0;
    for (std::uint32_t c = first_corner_[v]; c != none; c = next_corner_[c]) {
      if (count == VertexStar::most_facets) return false;
      corners[count++] = c;
    }
    if (count < 3) return false;
    // Sorts the facets around the vertex: each begins where the previous one ends.
    for (unsigned i = 0; i < count; ++i) {
      const std::uint32_t corner = corners[i], facet = corner / 3, one = corners[0] / 3;
      if (past_[facet].limit == 0 || mesh_.material[facet] != mesh_.material[one] ||
          mesh_.component[facet] != mesh_.component[one])
        return false;
      const VertexId end = at(onward(onward(corner)));
      if (i + 1 == count) {
        if (end != at(onward(corners[0]))) return false;
        break;
      }
      unsigned next = i + 1;
      while (next < count && at(onward(corners[next])) != end) ++next;
      if (next == count) return false;
      std::swap(corners[i + 1], corners[next]);
    }
    star.facets = count;
    for (unsigned i = 0; i < count; ++i) {
      const VertexId rim = at(onward(corners[i]));
      for (unsigned k = 0; k < i; ++k)
        if (at(onward(corners[k])) == rim) return false;
      star.ring[i] = between(mesh_.vertices[v], mesh_.vertices[rim]);
      star.past[i] = &past_[corners[i] / 3];
    }
    star.measure();
    return true;
  }

  void consider(VertexId v) {
    ++stamps_[v];
    VertexStar star;
    Ring corners;
    if (!gather(v, star, corners)) return;
    double least = std::numeric_limits<double>::infinity();
    for (unsigned t = 0; t < star.facets; ++t) least = std::min(least, star.cost_of(t));
    if (least <= hopeless) waiting_.push({static_cast<float>(least), v, stamps_[v]});
  }

  /// Returns whether the surface stays a manifold: the two vertices have no common neighbours except those of
  /// their edge.
  bool stays_a_sheet(const Ring& corners, unsigned count, unsigned target) const {
    const auto rim = [&](unsigned k) { return at(onward(corners[(target + k) % count])); };
    const VertexId to = rim(0);
    for (std::uint32_t c = first_corner_[to]; c != none; c = next_corner_[c]) {
      const VertexId a = at(onward(c)), b = at(onward(onward(c)));
      if (a == to || b == to) return false;  // a degenerate facet
      unsigned ends = 0;
      bool is_of_star = false;
      for (unsigned k = 0; k < count; ++k) is_of_star = is_of_star || corners[k] / 3 == c / 3;
      if (is_of_star) continue;
      for (unsigned k = 1; k < count; ++k) {
        if (rim(k) != a && rim(k) != b) continue;
        if (k != 1 && k + 1 != count) return false;
        ++ends;
      }
      if (ends == 2 && count == 3) return false;
    }
    return true;
  }

  void take_away(VertexId v) {
    VertexStar& star = star_;
    Ring corners;
    if (!gather(v, star, corners) || !look(v, corners, star, pieces_)) return;
    std::array<std::pair<double, unsigned>, VertexStar::most_facets> ways;
    for (unsigned t = 0; t < star.facets; ++t) ways[t] = {star.cost_of(t), t};
    std::sort(ways.begin(), ways.begin() + star.facets);
    for (unsigned k = 0; k < star.facets && ways[k].first <= hopeless; ++k) {
      const unsigned target = ways[k].second;
      if (!stays_a_sheet(corners, star.facets, target) || !star.becomes(target, most_turn_, parts_)) continue;
      collapse(corners, star.facets, target);
      return;
    }
  }

  void collapse(const Ring& corners, unsigned count, unsigned target) {
    Ring rim;
    for (unsigned k = 0; k < count; ++k) rim[k] = at(onward(corners[(target + k) % count]));
    const VertexId v = at(corners[0]);
    for (const unsigned gone : {target, (target + count - 1) % count}) {
      const std::uint32_t first = corners[gone] / 3 * 3;
      for (std::uint32_t c = first; c < first + 3; ++c) unlink(c);
      past_[first / 3].limit = -1;
      from_[first / 3] = {};
    }
    for (unsigned k = 1; k + 1 < count; ++k) {
      const std::uint32_t corner = corners[(target + k) % count];
      facets_[corner / 3][corner % 3] = rim[0];
      link(corner);
      const VertexStar::Part& part = parts_[k - 1];
      past_[corner / 3] = part.past;
      std::vector<FacetId>& from = from_[corner / 3];
      if (pieces_.empty()) {
        direction_[corner / 3] = -1;
        from = {};
        continue;
      }
      from.clear();
      for (const std::uint32_t piece : part.pieces) from.push_back(pieces_[piece]);
    }
    first_corner_[v] = none;
    ++stamps_[v];
    for (unsigned k = 0; k < count; ++k) consider(rim[k]);
  }

  CoarseMesh result() const {
    CoarseMesh coarse;
    coarse.mesh.vertices = mesh_.vertices;
    for (std::size_t f = 0; f < facets_.size(); ++f) {
      if (past_[f].limit < 0) continue;
      coarse.mesh.facets.push_back(facets_[f]);
      coarse.mesh.material.push_back(mesh_.material[f]);
      coarse.mesh.component.push_back(mesh_.component[f]);
      coarse.move.push_back(past_[f].moved());
      if (past_[f].limit > 0)
        coarse.largest_share = std::max(coarse.largest_share, past_[f].moved() / past_[f].limit);
      double turn_rad = 0;
      if (facets_[f] != mesh_.facets[f]) {
        const GridPoint a = mesh_.vertices[facets_[f][0]];
        const glm::dvec3 n = glm::normalize(
            glm::cross(between(a, mesh_.vertices[facets_[f][1]]), between(a, mesh_.vertices[facets_[f][2]])));
        turn_rad = 2 * std::asin(std::min(1.0, past_[f].normals.farthest_from(n) / 2));
      }
      coarse.turn_rad.push_back(turn_rad);
    }
    return coarse;
  }

  /// Collapses that cost more are rejected without further tests.
  static constexpr double hopeless = 4;

  const FacetMesh& mesh_;
  std::span<const double> most_move_;
  double most_turn_;
  std::vector<std::array<VertexId, 3>> facets_;
  std::vector<FacetPast> past_;  ///< per facet; a limit below 0 marks a removed facet
  /// Per facet: the axis along which its points have been moved, plus 3 for the opposite direction, or -1 for
  /// several axes. `from_` has the original facets that it replaces; empty for the facet itself.
  std::vector<std::int8_t> direction_;
  std::vector<std::vector<FacetId>> from_;
  std::vector<std::uint32_t> first_corner_,
      next_corner_;                    ///< corners of a vertex; facet f has the corners 3 f + 0, 1, 2
  std::vector<std::uint32_t> stamps_;  ///< per vertex: number of evaluations
  std::priority_queue<Waiting> waiting_;
  // Scratch memory:
  VertexStar star_;
  std::vector<FacetId> pieces_;  ///< of the star, if displacements are measured from the original positions
  std::vector<VertexStar::Part> parts_;
};

}  // namespace

CoarseMesh coarsened(const FacetMesh& mesh, std::span<const double> most_move, double most_turn_rad) {
  return Coarsener(mesh, most_move, most_turn_rad).coarse();
}

}  // namespace tubefoot
