// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/edge_refinement.hpp"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>

#include "geometry/mesh/weld_table.hpp"
#include "geometry/steps/steps.hpp"

// Cuts facets recursively at the midpoints of their edges. Weights and grid coordinates of the midpoints are
// exact, so two facets compute the same midpoint for their common edge. Several tasks cut in parallel; their
// points are welded in a fixed order (docs/notes/textures.md, "Refinement").

namespace tubefoot {
namespace {

constexpr std::uint32_t whole = 1u << deepest_refinement;

/// A point with the weights of the corners in parts of `whole` and its position in grid units. Both are
/// exact, so the midpoint of an edge is the same from either side. The coordinates need 31 bits and 22 bits
/// of fraction, which fit a double.
struct Node {
  glm::dvec3 at{0};
  std::array<std::uint32_t, 3> weight{};
};

Node middle(const Node& a, const Node& b) {
  Node m;
  m.at = 0.5 * (a.at + b.at);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t sum = a.weight[k] + b.weight[k];
    if (sum & 1u)
      throw std::range_error(fmt::format(
          "the refinement bisects a facet more than {} times: request larger parts", deepest_refinement));
    m.weight[k] = sum / 2;
  }
  return m;
}

double length2(glm::dvec3 v) { return v.x * v.x + v.y * v.y + v.z * v.z; }

/// Returns the edges that are cut now, from those that the rule cuts. Edges that are at most half as long as
/// the longest one are not cut yet. Edge k lies opposite to corner k.
unsigned cut_now(const std::array<double, 3>& edge2, unsigned wanted) {
  double longest2 = 0;
  for (unsigned k = 0; k < 3; ++k)
    if (wanted >> k & 1u) longest2 = std::max(longest2, edge2[k]);
  unsigned now = 0;
  for (unsigned k = 0; k < 3; ++k)
    if ((wanted >> k & 1u) && 4 * edge2[k] > longest2) now |= 1u << k;
  return now;
}

/// The parts of a facet whose edges are cut as `now` specifies. Numbers 0, 1, 2 are the corners and 3 + k is
/// the midpoint of edge k; parts turn as the facet does. A quadrilateral is divided by its shorter diagonal.
/// `other_diagonal` selects the diagonal from the midpoint of edge k + 2 to corner k + 2.
struct Parts {
  std::array<std::array<std::uint8_t, 3>, 4> part{};
  std::uint8_t count = 0;
  void add(std::uint8_t a, std::uint8_t b, std::uint8_t c) { part[count++] = {a, b, c}; }
};

Parts parts_of(unsigned now, bool other_diagonal) {
  Parts parts;
  const auto at = [](unsigned k) { return static_cast<std::uint8_t>(k % 3); };
  const auto on = [](unsigned k) { return static_cast<std::uint8_t>(3 + k % 3); };
  switch (std::popcount(now)) {
    case 0:
      parts.add(0, 1, 2);
      break;
    case 1: {
      const unsigned k = static_cast<unsigned>(std::countr_zero(now));
      parts.add(at(k), at(k + 1), on(k));
      parts.add(at(k), on(k), at(k + 2));
      break;
    }
    case 2: {
      // Edge k is not cut; the corner opposite to it is cut off.
      const unsigned k = static_cast<unsigned>(std::countr_zero(~now & 7u));
      parts.add(at(k), on(k + 2), on(k + 1));
      if (other_diagonal) {
        parts.add(on(k + 2), at(k + 1), at(k + 2));
        parts.add(on(k + 2), at(k + 2), on(k + 1));
      } else {
        parts.add(on(k + 2), at(k + 1), on(k + 1));
        parts.add(on(k + 1), at(k + 1), at(k + 2));
      }
      break;
    }
    default:
      for (unsigned k = 0; k < 3; ++k) parts.add(at(k), on(k + 2), on(k + 1));
      parts.add(3, 4, 5);
  }
  return parts;
}

/// Returns, for an uncut edge k, whether the diagonal from the midpoint of edge k + 2 to corner k + 2 is
/// shorter.
bool other_diagonal(const std::array<glm::dvec3, 3>& at, unsigned k) {
  const glm::dvec3 p = at[k % 3], q = at[(k + 1) % 3], r = at[(k + 2) % 3];
  return length2(0.5 * (p + q) - r) < length2(0.5 * (p + r) - q);
}

std::array<double, 3> edges2(const std::array<glm::dvec3, 3>& at) {
  return {length2(at[1] - at[2]), length2(at[2] - at[0]), length2(at[0] - at[1])};
}

/// A part of a base facet that may need further cuts.
struct FacetPart {
  FacetId facet = 0;
  std::array<Node, 3> node;
};

/// Evaluates the rule for points in grid units.
class Cutter {
 public:
  Cutter(const WorldGrid& grid, const EdgeRule& rule)
      : rule_(rule), origin_m_(grid.to_metres({})), unit_m_(grid.unit_m()) {}

  BasePoint base_point(FacetId facet, const Node& n) const {
    constexpr double part = 1.0 / whole;
    return {facet, {n.weight[0] * part, n.weight[1] * part, n.weight[2] * part}, origin_m_ + n.at * unit_m_};
  }

  /// Returns the edges that are cut now, and writes the resulting parts.
  unsigned ask(FacetId facet, const std::array<const Node*, 3>& n, Parts& parts) const {
    const std::array<BasePoint, 3> p{base_point(facet, *n[0]), base_point(facet, *n[1]),
                                     base_point(facet, *n[2])};
    unsigned wanted = 0;
    for (unsigned k = 0; k < 3; ++k)
      if (rule_.cuts(p[(k + 1) % 3], p[(k + 2) % 3])) wanted |= 1u << k;
    if (wanted == 0) return 0;
    const std::array<glm::dvec3, 3> at{n[0]->at, n[1]->at, n[2]->at};
    const unsigned now = cut_now(edges2(at), wanted);
    parts = parts_of(now, std::popcount(now) == 2 &&
                              other_diagonal(at, static_cast<unsigned>(std::countr_zero(~now & 7u))));
    return now;
  }

 private:
  const EdgeRule& rule_;
  glm::dvec3 origin_m_;
  double unit_m_;
};

/// The points of one base facet by number. The table finds the midpoint of two points if it exists already.
class Nodes {
 public:
  void restart(const std::array<Node, 3>& corners) {
    nodes.assign(corners.begin(), corners.end());
    if (used_ > 0) std::fill(slots_.begin(), slots_.end(), Slot{});
    used_ = 0;
  }

  std::uint32_t middle_of(std::uint32_t a, std::uint32_t b) {
    if (2 * (used_ + 1) > slots_.size()) grow();
    const std::uint64_t key = std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
    Slot& slot = slots_[place_of(key)];
    if (slot.key == 0) {  // empty slot: the two ends of an edge differ, so one number is not 0
      slot = {key, static_cast<std::uint32_t>(nodes.size())};
      nodes.push_back(middle(nodes[a], nodes[b]));
      ++used_;
    }
    return slot.node;
  }

  std::vector<Node> nodes;

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t node = 0;
  };

  std::size_t place_of(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    std::uint64_t h = key * 0x9e3779b97f4a7c15u;
    std::size_t k = static_cast<std::size_t>(h >> 32) & mask;
    while (slots_[k].key != 0 && slots_[k].key != key) k = (k + 1) & mask;
    return k;
  }

  void grow() {
    std::vector<Slot> old(std::max<std::size_t>(64, 2 * slots_.size()));
    old.swap(slots_);
    for (const Slot& s : old)
      if (s.key != 0) slots_[place_of(s.key)] = s;
  }

  std::vector<Slot> slots_;
  std::size_t used_ = 0;
};

/// The result of one task: facets that refer to the task's own numbers of points.
struct Yield {
  std::vector<GridPoint> points;
  std::vector<std::array<std::uint32_t, 3>> facets;
  std::vector<FacetId> parent;
  std::vector<PartWeights> weights;
};

class Refiner {
 public:
  Refiner(const FacetMesh& base, const WorldGrid& grid, const EdgeRule& rule, const PlaceOfPoint& place,
          const RefinementLimits& limits)
      : base_(base), grid_(grid), cutter_(grid, rule), place_(place), limits_(limits) {}

  RefinedMesh run(std::span<const FacetId> facets) {
    std::vector<FacetPart> parts;
    parts.reserve(facets.size());
    for (const FacetId f : facets) {
      FacetPart part{f, {}};
      for (std::size_t k = 0; k < 3; ++k) {
        const GridPoint p = base_.vertices[base_.facets[f][k]];
        part.node[k].at = {double(p.x), double(p.y), double(p.z)};
        part.node[k].weight[k] = whole;
      }
      parts.push_back(part);
    }
    spread(parts);
    const std::size_t tasks = std::min<std::size_t>(parts.size(), 4 * enough);
    std::vector<Yield> yields(tasks);
    Steps steps("refined surface parts", tasks);
    tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t t) {
      Nodes nodes;
      const std::size_t first = t * parts.size() / tasks, end = (t + 1) * parts.size() / tasks;
      for (std::size_t k = first; k < end; ++k) cut(parts[k], nodes, yields[t]);
      steps.done();
    });
    return joined(yields);
  }

 private:
  /// Cuts few large facets until there is work for all threads. The order remains that of the recursion.
  static constexpr std::size_t enough = 64;
  void spread(std::vector<FacetPart>& parts) const {
    for (bool more = true; more && parts.size() < enough;) {
      more = false;
      std::vector<FacetPart> next;
      for (const FacetPart& part : parts) {
        stop_if_wanted();
        Parts cut;
        const auto& n = part.node;
        const unsigned now = cutter_.ask(part.facet, {&n[0], &n[1], &n[2]}, cut);
        if (now == 0) {
          next.push_back(part);
          continue;
        }
        more = true;
        std::array<Node, 6> all{n[0], n[1], n[2]};
        for (unsigned k = 0; k < 3; ++k)
          if (now >> k & 1u) all[3 + k] = middle(n[(k + 1) % 3], n[(k + 2) % 3]);
        for (std::size_t p = 0; p < cut.count; ++p)
          next.push_back({part.facet, {all[cut.part[p][0]], all[cut.part[p][1]], all[cut.part[p][2]]}});
      }
      parts = std::move(next);
    }
  }

  void cut(const FacetPart& part, Nodes& nodes, Yield& out) {
    nodes.restart(part.node);
    const std::size_t first_facet = out.facets.size();
    const auto recur = [&](const auto& self, const std::array<std::uint32_t, 3>& corner) -> void {
      stop_if_wanted();
      Parts parts;
      const unsigned now = cutter_.ask(
          part.facet, {&nodes.nodes[corner[0]], &nodes.nodes[corner[1]], &nodes.nodes[corner[2]]}, parts);
      if (now == 0) {
        count_one_more();
        out.facets.push_back(corner);
        out.parent.push_back(part.facet);
        if (limits_.weights) out.weights.push_back(weights_of(nodes, corner));
        return;
      }
      std::array<std::uint32_t, 6> all{corner[0], corner[1], corner[2]};
      for (unsigned k = 0; k < 3; ++k)
        if (now >> k & 1u) all[3 + k] = nodes.middle_of(corner[(k + 1) % 3], corner[(k + 2) % 3]);
      for (std::size_t p = 0; p < parts.count; ++p)
        self(self, {all[parts.part[p][0]], all[parts.part[p][1]], all[parts.part[p][2]]});
    };
    recur(recur, {0, 1, 2});
    const auto before = static_cast<std::uint32_t>(out.points.size());
    for (std::size_t f = first_facet; f < out.facets.size(); ++f)
      for (std::uint32_t& v : out.facets[f]) v += before;
    for (const Node& n : nodes.nodes) {
      stop_if_wanted();
      out.points.push_back(grid_.snap(place_(cutter_.base_point(part.facet, n))));
    }
  }

  static PartWeights weights_of(const Nodes& nodes, const std::array<std::uint32_t, 3>& corner) {
    PartWeights weights{};
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < 2; ++k)
        weights[c][k] = std::int64_t{nodes.nodes[corner[c]].weight[k + 1]} * (whole_weight / whole);
    return weights;
  }

  void count_one_more() {
    if (made_.fetch_add(1, std::memory_order_relaxed) >= limits_.facets)
      throw RefinementTooLarge(fmt::format("the refinement creates more than {} facets", limits_.facets));
  }

  RefinedMesh joined(std::vector<Yield>& yields) const {
    RefinedMesh all;
    std::size_t facets = 0;
    for (const Yield& y : yields) facets += y.facets.size();
    all.mesh.facets.reserve(facets);
    all.mesh.material.reserve(facets);
    all.mesh.component.reserve(facets);
    all.parent.reserve(facets);
    if (limits_.weights) all.weights.reserve(facets);
    all.mesh.vertices.reserve(facets / 2 + 3);
    WeldTable weld(all.mesh.vertices);
    weld.reserve(facets / 2 + 3);
    std::vector<VertexId> id;
    for (Yield& y : yields) {
      stop_if_wanted();
      weld.reserve(all.mesh.vertices.size() + y.points.size());
      id.assign(y.points.size(), unnamed);
      for (std::size_t f = 0; f < y.facets.size(); ++f) {
        std::array<VertexId, 3> facet;
        for (std::size_t k = 0; k < 3; ++k) {
          VertexId& v = id[y.facets[f][k]];
          if (v == unnamed) v = weld.id_of(y.points[y.facets[f][k]]);
          facet[k] = v;
        }
        all.mesh.facets.push_back(facet);
        all.parent.push_back(y.parent[f]);
        all.mesh.material.push_back(base_.material[y.parent[f]]);
        all.mesh.component.push_back(base_.component[y.parent[f]]);
      }
      all.weights.insert(all.weights.end(), y.weights.begin(), y.weights.end());
      y = Yield{};
    }
    return all;
  }

  static constexpr VertexId unnamed = 0xffffffffu;
  const FacetMesh& base_;
  const WorldGrid& grid_;
  const Cutter cutter_;
  const PlaceOfPoint& place_;
  const RefinementLimits limits_;
  std::atomic<std::size_t> made_{0};
};

std::size_t count_uniform(const std::array<glm::dvec3, 3>& at, double longest2) {
  const std::array<double, 3> edge2 = edges2(at);
  unsigned wanted = 0;
  for (unsigned k = 0; k < 3; ++k)
    if (edge2[k] > longest2) wanted |= 1u << k;
  if (wanted == 0) return 1;
  const unsigned now = cut_now(edge2, wanted);
  // The four parts of a facet whose edges are all cut are congruent, because coordinates are exact.
  if (now == 7u) {
    const glm::dvec3 zero{0};
    return 4 * count_uniform({zero, 0.5 * (at[1] - at[0]), 0.5 * (at[2] - at[0])}, longest2);
  }
  const std::array<glm::dvec3, 6> all{
      at[0], at[1], at[2], 0.5 * (at[1] + at[2]), 0.5 * (at[2] + at[0]), 0.5 * (at[0] + at[1])};
  stop_if_wanted();
  const Parts parts = parts_of(
      now, std::popcount(now) == 2 && other_diagonal(at, static_cast<unsigned>(std::countr_zero(~now & 7u))));
  std::size_t sum = 0;
  for (std::size_t p = 0; p < parts.count; ++p)
    sum += count_uniform({all[parts.part[p][0]], all[parts.part[p][1]], all[parts.part[p][2]]}, longest2);
  return sum;
}

}  // namespace

RefinedMesh refine(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                   const EdgeRule& rule, const PlaceOfPoint& place, const RefinementLimits& limits) {
  return Refiner(base, grid, rule, place, limits).run(facets);
}

std::size_t uniform_count(const FacetMesh& base, FacetId facet, const WorldGrid& grid, double longest_m) {
  std::array<glm::dvec3, 3> at;
  for (std::size_t k = 0; k < 3; ++k) {
    const GridPoint p = base.vertices[base.facets[facet][k]];
    at[k] = {double(p.x), double(p.y), double(p.z)};
  }
  const double longest = longest_m / grid.unit_m();
  return count_uniform(at, longest * longest);
}

}  // namespace tubefoot
