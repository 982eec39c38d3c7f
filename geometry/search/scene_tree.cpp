// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/search/scene_tree.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <queue>

#include "geometry/search/height_fields.hpp"
#include "geometry/steps/stop.hpp"

// Builds a bounding-box tree by median splits along the longest axis of the facets' centroids. Queries
// traverse it and skip tests that a surrounding box already satisfies as a whole.

namespace tubefoot {
namespace {

constexpr std::uint32_t facets_per_leaf = 8;

GridPoint min(GridPoint a, GridPoint b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
GridPoint max(GridPoint a, GridPoint b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

/// Returns the distance from the origin to the interval [lo, hi].
double gap(double lo, double hi) { return lo > 0 ? lo : hi < 0 ? -hi : 0; }

/// Relative to the apex and to the size of the products; far larger than their rounding errors.
constexpr double slack = 1e-12;

/// The products of a normal's coordinates with those of the box corner that lies farthest along it, or
/// nearest.
struct Products {
  double x, y, z;
  double sum() const { return x + y + z; }
  double size() const { return std::abs(x) + std::abs(y) + std::abs(z); }
};

/// A box relative to the apex.
struct Reach {
  double lx, hx, ly, hy, lz, hz;
  Products farthest(const SceneTree::HalfSpace& h) const {
    return {h.x * (h.x > 0 ? hx : lx), h.y * (h.y > 0 ? hy : ly), h.z * (h.z > 0 ? hz : lz)};
  }
  Products nearest(const SceneTree::HalfSpace& h) const {
    return {h.x * (h.x > 0 ? lx : hx), h.y * (h.y > 0 ? ly : hy), h.z * (h.z > 0 ? lz : hz)};
  }
};

/// A facet and three times its centroid, in single precision, because it only determines the shape of the
/// tree.
struct CentredFacet {
  std::array<float, 3> centre;
  FacetId facet;
};

CentredFacet centred(const FacetMesh& mesh, FacetId facet) {
  CentredFacet made{{0, 0, 0}, facet};
  for (const VertexId v : mesh.facets[facet]) {
    const GridPoint p = mesh.vertices[v];
    made.centre[0] += static_cast<float>(p.x);
    made.centre[1] += static_cast<float>(p.y);
    made.centre[2] += static_cast<float>(p.z);
  }
  return made;
}

/// Moves the facets of [begin, end) that have no copy (the same three vertices) with a lower id to the front.
/// Returns the end of these facets.
std::uint32_t drop_copies(const FacetMesh& mesh, std::vector<CentredFacet>& order, std::uint32_t begin,
                          std::uint32_t end) {
  const auto key = [&mesh](const CentredFacet& f) {
    std::array<VertexId, 3> vertices = mesh.facets[f.facet];
    std::sort(vertices.begin(), vertices.end());
    return vertices;
  };
  const auto first = order.begin() + begin, last = order.begin() + end;
  std::sort(first, last, [&](const CentredFacet& f, const CentredFacet& g) {
    return std::pair(key(f), f.facet) < std::pair(key(g), g.facet);
  });
  const auto distinct = std::unique(
      first, last, [&](const CentredFacet& f, const CentredFacet& g) { return key(f) == key(g); });
  return static_cast<std::uint32_t>(distinct - order.begin());
}

/// Number of nodes of a tree of so many facets without copies. Halving gives all parts at one depth the same
/// size, except for a difference of one facet.
std::uint32_t nodes_for(std::uint32_t facets) {
  if (facets <= facets_per_leaf) return 1;
  std::uint32_t parts = 1;  // at the deepest level that has parts larger than a leaf
  while (facets > std::uint64_t{2} * parts * facets_per_leaf) parts *= 2;
  const std::uint32_t leaves = facets / parts > facets_per_leaf ? 2 * parts : parts + facets % parts;
  return 2 * leaves - 1;
}

/// Builds the nodes of a SceneTree. Each part of the facets has its own range of facets and of nodes. Threads
/// work on different parts, so the tree does not depend on their number.
template <class Node>
class TreeBuilder {
 public:
  TreeBuilder(const FacetMesh& mesh, std::vector<CentredFacet>& order)
      : mesh_(mesh), order_(order), nodes_(nodes_for(static_cast<std::uint32_t>(order.size()))) {
    split(0, 0, static_cast<std::uint32_t>(order.size()));
  }

  std::vector<Node> nodes() {
    if (!dropped_) return std::move(nodes_);
    std::vector<Node> dense;  // without the places of the nodes of copies
    const auto take = [&](const auto& self, std::uint32_t index) -> std::uint32_t {
      const auto place = static_cast<std::uint32_t>(dense.size());
      dense.push_back(nodes_[index]);
      if (nodes_[index].count > 0) return place;
      self(self, index + 1);
      dense[place].link = self(self, nodes_[index].link);
      return place;
    };
    take(take, 0);
    dense.shrink_to_fit();
    return dense;
  }

 private:
  void split(std::uint32_t index, std::uint32_t begin, std::uint32_t end) {
    stop_if_wanted();
    if (end - begin <= facets_per_leaf) {
      constexpr auto top = std::numeric_limits<std::int32_t>::max();
      decltype(Node::box) box{{top, top, top}, {-top, -top, -top}};
      for (std::uint32_t k = begin; k < end; ++k)
        for (const VertexId v : mesh_.facets[order_[k].facet]) {
          box.lo = min(box.lo, mesh_.vertices[v]);
          box.hi = max(box.hi, mesh_.vertices[v]);
        }
      nodes_[index] = {box, begin, end - begin};
      return;
    }
    std::array<float, 3> lo = order_[begin].centre, hi = lo;
    for (std::uint32_t k = begin; k < end; ++k)
      for (std::size_t a = 0; a < 3; ++a) {
        lo[a] = std::min(lo[a], order_[k].centre[a]);
        hi[a] = std::max(hi[a], order_[k].centre[a]);
      }
    std::size_t axis = 0;
    for (std::size_t a = 1; a < 3; ++a)
      if (hi[a] - lo[a] > hi[axis] - lo[axis]) axis = a;
    // No cut separates facets with equal centroids, and all pairs of them would have to be compared. Only the
    // visible copy of a facet is needed.
    if (hi[axis] == lo[axis])
      if (const std::uint32_t distinct = drop_copies(mesh_, order_, begin, end); distinct < end) {
        dropped_ = true;
        return split(index, begin, distinct);
      }
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(
        order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
        [axis](const CentredFacet& f, const CentredFacet& g) { return f.centre[axis] < g.centre[axis]; });
    const std::uint32_t first = index + 1, second = first + nodes_for(middle - begin);
    constexpr std::uint32_t worth_a_thread = 8192;
    if (end - begin >= worth_a_thread) {
      tbb::parallel_invoke([&] { split(first, begin, middle); }, [&] { split(second, middle, end); });
    } else {
      split(first, begin, middle);
      split(second, middle, end);
    }
    nodes_[index] = {
        {min(nodes_[first].box.lo, nodes_[second].box.lo), max(nodes_[first].box.hi, nodes_[second].box.hi)},
        second,
        0};
  }

  const FacetMesh& mesh_;
  std::vector<CentredFacet>& order_;
  std::vector<Node> nodes_;
  std::atomic<bool> dropped_ = false;  ///< whether nodes of copies are missing
};

}  // namespace

SceneTree::SceneTree(const FacetMesh& mesh, HeightFieldSearch height_fields) : mesh_(&mesh) {
  if (height_fields == HeightFieldSearch::ignored) {
    build(0);
    return;
  }
  std::shared_ptr<const HeightFields> found;
  // A thread that waits here must not take up other work, which might wait for this tree.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_invoke([&] { build(0); }, [&] { found = std::make_shared<const HeightFields>(mesh); });
  });
  if (found->count() > 0) height_fields_ = std::move(found);
}

SceneTree::SceneTree(const FacetMesh& mesh, std::shared_ptr<const SceneTree> at_rest, FacetId first_moving)
    : mesh_(&mesh), height_fields_(at_rest->height_fields_), at_rest_(std::move(at_rest)) {
  build(first_moving);
}

void SceneTree::build(FacetId first_facet) {
  const FacetMesh& mesh = *mesh_;
  std::vector<CentredFacet> order(mesh.facets.size() - first_facet);
  if (order.empty()) return;
  constexpr std::size_t block = 4096;
  const tbb::blocked_range<std::size_t> all(0, order.size(), block);
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(all, [&](const tbb::blocked_range<std::size_t>& part) {
      for (std::size_t k = part.begin(); k != part.end(); ++k)
        order[k] = centred(mesh, first_facet + static_cast<FacetId>(k));
    });
    nodes_ = TreeBuilder<Node>(mesh, order).nodes();
    order_.resize(order.size());
    tbb::parallel_for(all, [&](const tbb::blocked_range<std::size_t>& part) {
      for (std::size_t k = part.begin(); k != part.end(); ++k) order_[k] = order[k].facet;
    });
  });
}

std::size_t SceneTree::bytes() const {
  const std::size_t own = nodes_.capacity() * sizeof(Node) + order_.capacity() * sizeof(FacetId);
  if (at_rest_) return own + at_rest_->bytes();
  return own + (height_fields_ ? height_fields_->bytes() : 0);
}

void SceneTree::query(const std::function<bool(const GridPoint&, const GridPoint&)>& may_meet,
                      std::vector<FacetId>& out) const {
  if (at_rest_) at_rest_->query(may_meet, out);
  if (nodes_.empty()) return;
  std::array<std::uint32_t, 64> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t index = stack[--depth];
    const Node& node = nodes_[index];
    if (!may_meet(node.box.lo, node.box.hi)) continue;
    if (node.count == 0) {
      stack[depth++] = node.link;
      stack[depth++] = index + 1;
    } else {
      out.insert(out.end(), order_.begin() + node.link, order_.begin() + node.link + node.count);
    }
  }
}

/// Tests whether boxes may meet a pyramid. `checks` has the tests that are still necessary: bit k for side k,
/// the last bit for the reach. A test that a whole box satisfies is not repeated for the boxes inside it.
class SceneTree::PyramidTest {
 public:
  PyramidTest(GridPoint apex, std::span<const HalfSpace> sides, double reach, double margin)
      : apex_(apex), sides_(sides), reach2_(reach * reach), margin_(margin), reach_bit_(1u << sides.size()) {}

  unsigned all_checks() const { return 2 * reach_bit_ - 1; }

  double distance(const Box& box) const {
    const Reach own = relative(box);
    return std::sqrt(squared_distance(own));
  }

  /// With `has_inner`, `checks` is reduced to the tests that the boxes inside still need.
  template <bool has_inner>
  bool meets(const Box& box, unsigned& checks) const {
    const Reach own = relative(box);
    if (checks & reach_bit_) {
      if (squared_distance(own) > reach2_) return false;
      if constexpr (has_inner) {
        const double fx = std::max(-own.lx, own.hx), fy = std::max(-own.ly, own.hy),
                     fz = std::max(-own.lz, own.hz);
        if (fx * fx + fy * fy + fz * fz <= reach2_) checks &= ~reach_bit_;
      }
    }
    for (std::size_t k = 0; k < sides_.size(); ++k) {
      if (!(checks >> k & 1u)) continue;
      const Products far = own.farthest(sides_[k]);
      if (far.sum() < -slack * far.size()) return false;
      if constexpr (has_inner)
        if (own.nearest(sides_[k]).sum() >= 0) checks &= ~(1u << k);
    }
    return true;
  }

 private:
  Reach relative(const Box& box) const {
    return {double(box.lo.x) - apex_.x - margin_, double(box.hi.x) - apex_.x + margin_,
            double(box.lo.y) - apex_.y - margin_, double(box.hi.y) - apex_.y + margin_,
            double(box.lo.z) - apex_.z - margin_, double(box.hi.z) - apex_.z + margin_};
  }
  static double squared_distance(const Reach& box) {
    const double dx = gap(box.lx, box.hx), dy = gap(box.ly, box.hy), dz = gap(box.lz, box.hz);
    return dx * dx + dy * dy + dz * dz;
  }

  GridPoint apex_;
  std::span<const HalfSpace> sides_;
  double reach2_, margin_;
  unsigned reach_bit_;
};

void SceneTree::take_leaf(const Node& leaf, const PyramidTest& test, unsigned checks,
                          std::vector<FacetId>& out) const {
  for (std::uint32_t k = leaf.link; k < leaf.link + leaf.count; ++k) {
    // The facet's own box decides, so that the result does not depend on the shape of the tree.
    const auto& facet = mesh_->facets[order_[k]];
    const GridPoint a = mesh_->vertices[facet[0]], b = mesh_->vertices[facet[1]],
                    c = mesh_->vertices[facet[2]];
    if (checks == 0 || test.meets<false>({min(min(a, b), c), max(max(a, b), c)}, checks))
      out.push_back(order_[k]);
  }
}

void SceneTree::query(GridPoint apex, std::span<const HalfSpace> half_spaces, double reach, double margin,
                      std::vector<FacetId>& out) const {
  if (at_rest_) at_rest_->query(apex, half_spaces, reach, margin, out);
  if (nodes_.empty()) return;
  const PyramidTest test(apex, half_spaces, reach, margin);
  struct Visit {
    std::uint32_t node;
    unsigned checks;
  };
  std::array<Visit, 64> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, test.all_checks()};
  while (depth > 0) {
    auto [index, checks] = stack[--depth];
    const Node& node = nodes_[index];
    if (!test.meets<true>(node.box, checks)) continue;
    if (node.count > 0) {
      take_leaf(node, test, checks, out);
      continue;
    }
    stack[depth++] = {node.link, checks};
    stack[depth++] = {index + 1, checks};
  }
}

std::size_t SceneTree::count(GridPoint apex, std::span<const HalfSpace> half_spaces, double reach) const {
  std::size_t found = at_rest_ ? at_rest_->count(apex, half_spaces, reach) : 0;
  const PyramidTest test(apex, half_spaces, reach, 0);
  // build() divides the facets of a node in halves, and omits copies.
  const auto visit = [&](const auto& self, std::uint32_t index, std::size_t facets, unsigned checks) -> void {
    const Node& node = nodes_[index];
    if (!test.meets<true>(node.box, checks)) return;
    if (node.count > 0 || checks == 0) {
      found += facets;
      return;
    }
    self(self, index + 1, facets / 2, checks);
    self(self, node.link, facets - facets / 2, checks);
  };
  if (!nodes_.empty()) visit(visit, 0, order_.size(), test.all_checks());
  return found;
}

void SceneTree::query_by_distance(GridPoint apex, std::span<const HalfSpace> half_spaces, double reach,
                                  const NeedsBox& needs, std::vector<FacetId>& out) const {
  const PyramidTest test(apex, half_spaces, reach, 0);
  struct Visit {
    double distance;
    const SceneTree* tree;
    std::uint32_t node;
    unsigned checks;
    bool operator<(const Visit& other) const { return distance > other.distance; }  // the nearest is on top
  };
  std::priority_queue<Visit> visits;
  const auto add = [&](const SceneTree& tree, std::uint32_t node, unsigned checks) {
    if (const Box& box = tree.nodes_[node].box; test.meets<true>(box, checks))
      visits.push({test.distance(box), &tree, node, checks});
  };
  for (const SceneTree* tree = this; tree; tree = tree->at_rest_.get())
    if (!tree->nodes_.empty()) add(*tree, 0, test.all_checks());
  while (!visits.empty()) {
    const Visit visit = visits.top();
    visits.pop();
    const Node& node = visit.tree->nodes_[visit.node];
    if (!needs(node.box.lo, node.box.hi, visit.distance)) continue;
    if (node.count > 0) {
      visit.tree->take_leaf(node, test, visit.checks, out);
      continue;
    }
    add(*visit.tree, node.link, visit.checks);
    add(*visit.tree, visit.node + 1, visit.checks);
  }
}

}  // namespace tubefoot
