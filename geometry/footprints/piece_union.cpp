// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/piece_union.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <map>

#include "geometry/numbers/scalars.hpp"

// Unites convex pieces of one plane. Edges that two pieces traverse in opposite directions cancel. The
// remaining edges are linked to rings, which are outer rings or holes by the sign of their area.

namespace tubefoot {
namespace {

using Corner = std::uint32_t;
using Edge = std::pair<Corner, Corner>;
using Ring = std::vector<Corner>;

/// Returns twice the area of a ring, as a vector.
template <class At>
glm::dvec3 area_vector(std::size_t count, const At& at) {
  glm::dvec3 sum(0);
  for (std::size_t k = 1; k + 1 < count; ++k) sum += glm::cross(at(k) - at(0), at(k + 1) - at(0));
  return sum;
}

class Union {
 public:
  Union(std::span<const glm::dvec3> corners, std::span<const Piece> pieces)
      : corners_(corners), pieces_(pieces) {
    double size = 1;
    for (const Piece& piece : pieces)
      for (Corner k = piece.first; k < piece.first + piece.count; ++k)
        size = std::max({size, std::abs(corners[k].x), std::abs(corners[k].y), std::abs(corners[k].z)});
    near_ = 1e-11 * size;
    flatten();
    weld();
  }

  std::optional<std::vector<RingedPolygon>> polygons() {
    std::vector<Edge> edges;
    for (const Piece& piece : pieces_)
      for (Corner k = 0; k < piece.count; ++k) {
        const Corner from = same_[piece.first + k], to = same_[piece.first + (k + 1) % piece.count];
        if (from != to) edges.emplace_back(from, to);
      }
    edges = without_shared(edges);
    edges = without_shared(split_at_corners(edges));
    return arranged(edges);
  }

 private:
  /// Computes coordinates in the plane of the pieces, in which the pieces turn counter-clockwise.
  void flatten() {
    glm::dvec3 normal(0);
    for (const Piece& piece : pieces_)
      normal += area_vector(piece.count, [&](std::size_t k) { return corners_[piece.first + k]; });
    const double length = glm::length(normal);
    normal = length > 0 ? normal / length : glm::dvec3(0, 0, 1);
    const glm::dvec3 aside = std::abs(normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(aside, normal)), v = glm::cross(normal, u);
    const glm::dvec3 origin = corners_[pieces_.front().first];
    flat_.resize(corners_.size());
    same_.resize(corners_.size());
    for (const Piece& piece : pieces_)
      for (Corner k = piece.first; k < piece.first + piece.count; ++k) {
        flat_[k] = {glm::dot(corners_[k] - origin, u), glm::dot(corners_[k] - origin, v)};
        used_.push_back(k);
        same_[k] = k;
      }
  }

  /// Maps coincident corners to the one with the smallest number.
  void weld() {
    std::vector<Corner> by_x = used_;
    std::sort(by_x.begin(), by_x.end(), [&](Corner a, Corner b) {
      return flat_[a].x < flat_[b].x || (flat_[a].x == flat_[b].x && a < b);
    });
    for (std::size_t i = 0; i < by_x.size(); ++i)
      for (std::size_t j = i + 1; j < by_x.size() && flat_[by_x[j]].x - flat_[by_x[i]].x <= near_; ++j)
        if (glm::distance(corners_[by_x[i]], corners_[by_x[j]]) <= near_) {
          const Corner a = root(by_x[i]), b = root(by_x[j]);
          same_[std::max(a, b)] = std::min(a, b);
        }
    for (const Corner k : used_) same_[k] = root(k);
  }
  Corner root(Corner k) const {
    while (same_[k] != k) k = same_[k];
    return k;
  }

  /// Removes pairs of edges with opposite directions, because they lie inside the union.
  static std::vector<Edge> without_shared(const std::vector<Edge>& edges) {
    std::map<Edge, int> times;
    for (const Edge& edge : edges) ++times[edge];
    std::vector<Edge> left;
    for (const auto& [edge, count] : times) {
      const auto back = times.find({edge.second, edge.first});
      for (int k = back == times.end() ? 0 : back->second; k < count; ++k) left.push_back(edge);
    }
    return left;
  }

  /// Splits edges at the corners of other edges that lie on them.
  std::vector<Edge> split_at_corners(const std::vector<Edge>& edges) const {
    std::vector<Corner> by_x;
    for (const Edge& edge : edges) by_x.push_back(edge.first);
    const auto less = [&](Corner a, Corner b) {
      return flat_[a].x < flat_[b].x || (flat_[a].x == flat_[b].x && a < b);
    };
    std::sort(by_x.begin(), by_x.end(), less);
    by_x.erase(std::unique(by_x.begin(), by_x.end()), by_x.end());
    std::vector<Edge> cut;
    for (const auto& [from, to] : edges) {
      const glm::dvec2 begin = flat_[from], way = flat_[to] - begin;
      const double length2 = glm::dot(way, way), length = std::sqrt(length2);
      const double left = std::min(begin.x, flat_[to].x) - near_,
                   right = std::max(begin.x, flat_[to].x) + near_;
      std::vector<std::pair<double, Corner>> on;
      for (auto at = std::lower_bound(by_x.begin(), by_x.end(), left,
                                      [&](Corner k, double x) { return flat_[k].x < x; });
           at != by_x.end() && flat_[*at].x <= right; ++at) {
        if (*at == from || *at == to) continue;
        const glm::dvec2 off = flat_[*at] - begin;
        const double place = glm::dot(off, way) / length2;
        if (place > 0 && place < 1 && std::abs(cross(way, off)) <= near_ * length)
          on.emplace_back(place, *at);
      }
      std::sort(on.begin(), on.end());
      Corner last = from;
      for (const auto& [place, corner] : on) {
        cut.emplace_back(last, corner);
        last = corner;
      }
      cut.emplace_back(last, to);
    }
    return cut;
  }

  /// Returns the edge out of `to` that bounds the same interior as (from, to). This is the first edge
  /// clockwise from the reverse of (from, to).
  std::optional<std::size_t> next_of(const Edge& edge, const std::vector<Edge>& edges,
                                     const std::vector<bool>& taken) const {
    const auto [from, to] = edge;
    const glm::dvec2 back = flat_[from] - flat_[to];
    std::optional<std::size_t> best;
    double least = 0;
    for (auto at = std::lower_bound(edges.begin(), edges.end(), Edge{to, 0});
         at != edges.end() && at->first == to; ++at) {
      const auto number = static_cast<std::size_t>(at - edges.begin());
      if (taken[number]) continue;
      const glm::dvec2 ahead = flat_[at->second] - flat_[to];
      double turn = -std::atan2(cross(back, ahead), glm::dot(back, ahead));  // clockwise
      if (turn <= 0) turn += 2 * std::acos(-1.0);
      if (best && turn >= least) continue;
      best = number;
      least = turn;
    }
    return best;
  }

  double area(const Ring& ring) const {
    double sum = 0;
    for (std::size_t k = 1; k + 1 < ring.size(); ++k)
      sum += cross(flat_[ring[k]] - flat_[ring[0]], flat_[ring[k + 1]] - flat_[ring[0]]);
    return sum / 2;
  }

  bool holds(const Ring& ring, glm::dvec2 p) const {
    bool inside = false;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const glm::dvec2 a = flat_[ring[k]], b = flat_[ring[(k + 1) % ring.size()]];
      if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
    }
    return inside;
  }

  /// Splits a closed path into rings that visit no corner twice.
  static void add_simple(const Ring& way, std::vector<Ring>& rings) {
    Ring open;
    std::map<Corner, std::size_t> place;
    for (const Corner corner : way) {
      if (const auto seen = place.find(corner); seen != place.end()) {
        const std::size_t begin = seen->second;
        rings.emplace_back(open.begin() + static_cast<std::ptrdiff_t>(begin), open.end());
        for (std::size_t k = begin + 1; k < open.size(); ++k) place.erase(open[k]);
        open.resize(begin + 1);
        continue;
      }
      place[corner] = open.size();
      open.push_back(corner);
    }
    rings.push_back(open);
  }

  std::optional<std::vector<RingedPolygon>> arranged(std::vector<Edge> edges) const {
    std::sort(edges.begin(), edges.end());
    std::vector<bool> taken(edges.size(), false);
    std::vector<RingedPolygon> made;
    std::vector<Ring> holes;
    for (std::size_t first = 0; first < edges.size(); ++first) {
      if (taken[first]) continue;
      Ring way;
      for (std::size_t at = first;;) {
        taken[at] = true;
        way.push_back(edges[at].first);
        const std::optional<std::size_t> next = next_of(edges[at], edges, taken);
        if (edges[at].second == edges[first].first && (!next || !closes_later(edges, taken, first, at)))
          break;
        if (!next) return std::nullopt;
        at = *next;
      }
      std::vector<Ring> rings;
      add_simple(way, rings);
      for (Ring& ring : rings) {
        if (ring.size() < 3) continue;
        if (area(ring) > 0)
          made.push_back({std::move(ring)});
        else
          holes.push_back(std::move(ring));
      }
    }
    for (Ring& hole : holes) {
      const glm::dvec2 middle = (flat_[hole[0]] + flat_[hole[1]]) * 0.5;
      RingedPolygon* around = nullptr;
      for (RingedPolygon& polygon : made)
        if (holds(polygon.front(), middle) && (!around || area(polygon.front()) < area(around->front())))
          around = &polygon;
      if (!around) return std::nullopt;
      around->push_back(std::move(hole));
    }
    return made;
  }

  /// Returns whether a path that is back at its start continues. It continues if its first edge does not
  /// bound the same interior as its last edge.
  bool closes_later(const std::vector<Edge>& edges, std::vector<bool>& taken, std::size_t first,
                    std::size_t last) const {
    taken[first] = false;
    const std::optional<std::size_t> next = next_of(edges[last], edges, taken);
    taken[first] = true;
    return next != first;
  }

  std::span<const glm::dvec3> corners_;
  std::span<const Piece> pieces_;
  double near_ = 0;
  std::vector<glm::dvec2> flat_;
  std::vector<Corner> used_, same_;
};

}  // namespace

std::optional<std::vector<RingedPolygon>> united(std::span<const glm::dvec3> corners,
                                                 std::span<const Piece> pieces) {
  if (pieces.empty()) return std::vector<RingedPolygon>{};
  return Union(corners, pieces).polygons();
}

}  // namespace tubefoot
