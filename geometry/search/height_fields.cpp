// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/search/height_fields.hpp"

#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <numeric>

#include "geometry/arithmetic/arithmetic_fixed.hpp"
#include "geometry/arithmetic/cone_clip.hpp"
#include "geometry/mesh/facet_cone.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/search/vertical_line.hpp"
#include "geometry/steps/stop.hpp"

// Proves that connected parts of a mesh are height fields, and finds those that a tube sees only from above.
// The proof uses winding numbers of the border in plan view, in integers. Rays can pass below a border edge
// only through a vertical curtain that hangs from it (docs/notes/visibility.md).

namespace tubefoot {
namespace {

struct PlanPoint {
  std::int64_t x, y;
  friend bool operator==(const PlanPoint&, const PlanPoint&) = default;
};

/// A border edge in plan view, with the part on its left.
struct PlanEdge {
  PlanPoint from, to;
};

int turn(PlanPoint a, PlanPoint b, PlanPoint p) {
  return sign(Int128(b.x - a.x) * (p.y - a.y) - Int128(b.y - a.y) * (p.x - a.x));
}

/// Returns the doubled coordinates, so that the midpoint of an edge is also an integer point.
PlanPoint plan(GridPoint p) { return {2 * std::int64_t(p.x), 2 * std::int64_t(p.y)}; }

int plan_turn(const FacetMesh& mesh, FacetId facet) {
  const auto& v = mesh.facets[facet];
  return turn(plan(mesh.vertices[v[0]]), plan(mesh.vertices[v[1]]), plan(mesh.vertices[v[2]]));
}

// --- Parts as sets of facets. Two facets are joined across a common edge if they traverse the edge in
// opposite directions and turn the same way in plan view. The edge must have no third facet.

struct Side {
  VertexId other;
  std::uint32_t half_edge;  ///< 4 facet + edge
};

class Joiner {
 public:
  explicit Joiner(const FacetMesh& mesh) : mesh_(mesh), parent_(mesh.facets.size()) {
    std::iota(parent_.begin(), parent_.end(), 0u);
    join();
  }
  std::uint32_t root(std::uint32_t f) {
    while (parent_[f] != f) f = parent_[f] = parent_[parent_[f]];
    return f;
  }
  /// Half-edges across which no facets were joined.
  const std::vector<std::uint32_t>& borders() const { return borders_; }

 private:
  VertexId corner(std::uint32_t half_edge, std::uint32_t step) const {
    return mesh_.facets[half_edge / 4][(half_edge % 4 + step) % 3];
  }

  void join() {
    std::vector<std::uint32_t> end(mesh_.vertices.size() + 1, 0);
    const auto each_half_edge = [&](const auto& visit) {
      for (std::uint32_t f = 0; f < mesh_.facets.size(); ++f)
        for (std::uint32_t k = 0; k < 3; ++k) visit(4 * f + k);
    };
    const auto low = [&](std::uint32_t h) { return std::min(corner(h, 0), corner(h, 1)); };
    each_half_edge([&](std::uint32_t h) { ++end[low(h) + 1]; });
    std::partial_sum(end.begin(), end.end(), end.begin());
    std::vector<Side> sides(end.back());
    std::vector<std::uint32_t> next(end.begin(), end.end() - 1);
    each_half_edge([&](std::uint32_t h) {
      sides[next[low(h)]++] = {std::max(corner(h, 0), corner(h, 1)), h};
    });
    for (VertexId v = 0; v + 1 < end.size(); ++v) {
      stop_if_wanted();
      const auto first = sides.begin() + end[v], last = sides.begin() + end[v + 1];
      std::sort(first, last, [](const Side& a, const Side& b) {
        return a.other != b.other ? a.other < b.other : a.half_edge < b.half_edge;
      });
      for (auto group = first; group != last;) {
        const auto group_end =
            std::find_if(group, last, [&](const Side& s) { return s.other != group->other; });
        if (group_end - group != 2 || !unite(group[0].half_edge, group[1].half_edge))
          for (; group != group_end; ++group) borders_.push_back(group->half_edge);
        group = group_end;
      }
    }
  }

  bool unite(std::uint32_t g, std::uint32_t h) {
    if (corner(g, 0) != corner(h, 1)) return false;
    const int turns = plan_turn(mesh_, g / 4);
    if (turns == 0 || turns != plan_turn(mesh_, h / 4)) return false;
    parent_[root(g / 4)] = root(h / 4);
    return true;
  }

  const FacetMesh& mesh_;
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint32_t> borders_;
};

// --- The proof. The number of facets above a point of the plan is the winding number of the border about the
// point. The reason is that the borders of facets that all turn left add up to the border of the part.
// Suppose that no two border edges meet except at their ends. Then every face of the plan that they bound has
// a border edge. It suffices that each edge has winding number 1 on its left, and thus 0 on its right.

using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 2, const PlanEdge*>;

Box box_of(const PlanEdge& e) {
  return Box(CGAL::Bbox_2(double(std::min(e.from.x, e.to.x)), double(std::min(e.from.y, e.to.y)),
                          double(std::max(e.from.x, e.to.x)), double(std::max(e.from.y, e.to.y))),
             &e);
}

bool meet_only_at_ends(const PlanEdge& e, const PlanEdge& f) {
  const int a = turn(e.from, e.to, f.from), b = turn(e.from, e.to, f.to), c = turn(f.from, f.to, e.from),
            d = turn(f.from, f.to, e.to);
  if (a * b > 0 || c * d > 0) return true;
  if (a == 0 && b == 0) {
    // The edges lie on one line and their boxes meet. They may share only a common end, from which they run
    // in opposite directions.
    const auto run_apart = [](PlanPoint common, PlanPoint p, PlanPoint q) {
      return Int128(p.x - common.x) * (q.x - common.x) + Int128(p.y - common.y) * (q.y - common.y) < 0;
    };
    return (e.from == f.to && run_apart(e.from, e.to, f.from)) ||
           (e.to == f.from && run_apart(e.to, e.from, f.to)) ||
           (e.from == f.from && run_apart(e.from, e.to, f.to)) ||
           (e.to == f.to && run_apart(e.to, e.from, f.from));
  }
  return e.from == f.from || e.from == f.to || e.to == f.from || e.to == f.to;
}

bool edges_meet_only_at_ends(const std::vector<PlanEdge>& edges) {
  std::vector<Box> boxes;
  for (const PlanEdge& e : edges) boxes.push_back(box_of(e));
  bool good = true;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) {
    stop_if_wanted();
    good = good && meet_only_at_ends(*a.info(), *b.info());
  });
  return good;
}

/// Returns whether the winding number is 1 on the left of each edge that runs more along x than along y.
/// Crossings are counted on the vertical ray up from its midpoint, moved right by an infinitesimal step.
bool left_is_inside(const std::vector<PlanEdge>& edges) {
  std::vector<Box> rays, boxes;
  double top = 0;
  for (const PlanEdge& e : edges) {
    boxes.push_back(box_of(e));
    top = std::max(top, boxes.back().bbox().ymax());
  }
  for (const PlanEdge& e : edges) {
    if (std::abs(e.to.x - e.from.x) < std::abs(e.to.y - e.from.y)) continue;
    const double x = double((e.from.x + e.to.x) / 2), y = double((e.from.y + e.to.y) / 2);
    rays.emplace_back(CGAL::Bbox_2(x, y, x, top), &e);
  }
  std::vector<int> winding(edges.size(), 0);
  bool good = true;
  CGAL::box_intersection_d(rays.begin(), rays.end(), boxes.begin(), boxes.end(),
                           [&](const Box& ray, const Box& box) {
                             stop_if_wanted();
                             const PlanEdge &e = *ray.info(), &f = *box.info();
                             if (&e == &f) return;
                             const PlanPoint m{(e.from.x + e.to.x) / 2, (e.from.y + e.to.y) / 2};
                             if ((f.from.x <= m.x) == (f.to.x <= m.x)) return;  // not above the midpoint
                             const bool leftwards = f.to.x < f.from.x;
                             const int s = turn(f.from, f.to, m);
                             good = good && s != 0;
                             const bool above = leftwards ? s > 0 : s < 0;  // f above m
                             if (above)
                               winding[static_cast<std::size_t>(&e - edges.data())] += leftwards ? 1 : -1;
                           });
  for (const Box& ray : rays) {
    const PlanEdge& e = *ray.info();
    const int above = winding[static_cast<std::size_t>(&e - edges.data())];
    good = good && above == (e.to.x > e.from.x ? 1 : 0);
  }
  return good;
}

bool bounds_a_graph(std::vector<PlanEdge> edges) {
  if (!edges_meet_only_at_ends(edges) || !left_is_inside(edges)) return false;
  for (PlanEdge& e : edges)  // The exchange of x and y exchanges left and right, so each edge is reversed.
    e = {{e.to.y, e.to.x}, {e.from.y, e.from.x}};
  return left_is_inside(edges);
}

// --- Views

/// Returns whether two cones have a common interior direction: that of three directions with a positive
/// determinant, and that of a tube. Exact.
bool cones_meet(const std::array<GridPoint, 3>& points, const std::array<GridPoint, 4>& rays) {
  const FixedArithmetic arithmetic;
  std::array<ClipPlane<FixedArithmetic>, 7> planes;
  const auto half = [&](std::size_t k, GridPoint a, PointId a_name, GridPoint b, PointId b_name) {
    planes[k].name = {a_name, b_name, false};
    planes[k].points[0] = a;
    planes[k].points[1] = b;
    arithmetic.through(planes[k].plane, a, b);
    return Half<FixedArithmetic>{&planes[k], 1};
  };
  thread_local CornerBuffer<FixedArithmetic> buffer;  // reused, so that repeated calls allocate nothing
  buffer.clear();
  for (std::uint32_t k = 0; k < 3; ++k)
    point_corner(arithmetic, k, points[k], half(k, points[k], k, points[(k + 1) % 3], (k + 1) % 3),
                 buffer.emplace_back());
  PieceRange piece{0, 3};
  for (std::uint32_t w = 0; w < 4 && piece.count >= 3; ++w) {
    const auto wall = half(3 + w, rays[w], ray_bit | w, rays[(w + 1) % 4], ray_bit | (w + 1) % 4);
    std::array<int, 3 + 4> sides;  // three corners, and each wall adds at most one
    bool inside = false, outside = false;
    for (std::uint32_t k = 0; k < piece.count; ++k) {
      sides[k] = side(arithmetic, buffer[piece.first + k], wall);
      inside |= sides[k] > 0;
      outside |= sides[k] < 0;
    }
    if (!inside) return false;
    if (outside) piece = clip(arithmetic, buffer, piece, wall, sides.data());
  }
  return piece.count >= 3;
}

/// Returns whether rays of the tube may pass below a border edge. The part is on the left of the edge and the
/// apex on its right or on its line.
bool enters_below(GridPoint from, GridPoint to, GridPoint apex, const std::array<GridPoint, 4>& rays) {
  // An apex on the line may be on the border itself. Rays on both sides of the line may then start below it.
  if (turn(plan(from), plan(to), plan(apex)) == 0) return true;
  return cones_meet({from - apex, to - apex, GridPoint{0, 0, -1}}, rays);
}

}  // namespace

HeightFields::HeightFields(const FacetMesh& mesh) {
  Joiner joiner(mesh);
  std::vector<std::uint32_t> size(mesh.facets.size(), 0);
  for (std::uint32_t f = 0; f < size.size(); ++f) ++size[joiner.root(f)];
  std::vector<std::uint32_t> borders;  // borders of parts that are large enough, part by part
  for (const std::uint32_t h : joiner.borders())
    if (size[joiner.root(h / 4)] >= fewest_facets) borders.push_back(h);
  std::sort(borders.begin(), borders.end(), [&](std::uint32_t g, std::uint32_t h) {
    const std::uint32_t r = joiner.root(g / 4), s = joiner.root(h / 4);
    return r != s ? r < s : g < h;
  });

  std::vector<std::uint16_t> height_field_of_root(mesh.facets.size(), none);
  std::vector<PlanEdge> edges;
  for (std::size_t begin = 0; begin < borders.size() && turn_.size() < none;) {
    const std::uint32_t root = joiner.root(borders[begin] / 4);
    const int turns = plan_turn(mesh, root);
    std::size_t end = begin;
    edges.clear();
    for (; end < borders.size() && joiner.root(borders[end] / 4) == root; ++end) {
      const auto& v = mesh.facets[borders[end] / 4];
      const std::uint32_t k = borders[end] % 4;
      const PlanPoint a = plan(mesh.vertices[v[k]]), b = plan(mesh.vertices[v[(k + 1) % 3]]);
      edges.push_back(turns > 0 ? PlanEdge{a, b} : PlanEdge{b, a});
    }
    if (turns != 0 && bounds_a_graph(edges)) {
      const auto height_field = static_cast<std::uint16_t>(turn_.size());
      height_field_of_root[root] = height_field;
      turn_.push_back(static_cast<std::int8_t>(turns));
      for (std::size_t b = begin; b < end; ++b) {
        const auto& v = mesh.facets[borders[b] / 4];
        const std::uint32_t k = borders[b] % 4;
        const GridPoint from = mesh.vertices[v[turns > 0 ? k : (k + 1) % 3]],
                        to = mesh.vertices[v[turns > 0 ? (k + 1) % 3 : k]];
        const auto first = static_cast<VertexId>(curtains_.vertices.size());
        curtains_.vertices.insert(curtains_.vertices.end(),
                                  {from, to, {from.x, from.y, std::numeric_limits<std::int32_t>::min()}});
        curtains_.facets.push_back({first, first + 1, first + 2});
        curtains_.component.push_back(height_field);
      }
    }
    begin = end;
  }
  if (turn_.empty()) return;
  height_field_.resize(mesh.facets.size());
  for (std::uint32_t f = 0; f < height_field_.size(); ++f)
    height_field_[f] = height_field_of_root[joiner.root(f)];
  curtain_tree_ = std::make_unique<SceneTree>(curtains_, SceneTree::HeightFieldSearch::ignored);
}

HeightFields::~HeightFields() = default;

void HeightFields::look(const FacetMesh& mesh, const SceneTree& tree, GridPoint apex,
                        const std::array<GridPoint, 4>& rays,
                        std::span<const SceneTree::HalfSpace> half_spaces, double reach, View& view) const {
  view.from_above.assign(turn_.size(), 1);
  if (turn_.empty()) return;
  // Rays pass below a border edge only through the curtain that hangs from it, from its outer side.
  view.found.clear();
  curtain_tree_->query(apex, half_spaces, reach, view.found);
  for (const FacetId curtain : view.found) {
    const auto& v = curtains_.facets[curtain];
    std::uint8_t& from_above = view.from_above[curtains_.component[curtain]];
    const GridPoint from = curtains_.vertices[v[0]], to = curtains_.vertices[v[1]];
    if (from_above && turn(plan(from), plan(to), plan(apex)) <= 0 && enters_below(from, to, apex, rays))
      from_above = 0;
  }
  look_down(mesh, tree, apex, view);
}

/// Clears the flag of each height field above the apex. The apex must be above every height field or outside
/// of its plan.
void HeightFields::look_down(const FacetMesh& mesh, const SceneTree& tree, GridPoint apex, View& view) const {
  // The test point is one unit lower, because the apex itself must be above the part and not on it.
  const GridPoint below{apex.x, apex.y, apex.z - 1};
  view.found.clear();
  facets_near_vertical(tree, below, view.found);
  for (const FacetId facet : view.found)
    if (const std::uint16_t height_field = height_field_of(facet);
        height_field != none && vertical_side(mesh, facet, below) > 0)
      view.from_above[height_field] = 0;
}

std::size_t HeightFields::bytes() const {
  return height_field_.capacity() * sizeof(height_field_[0]) +
         curtains_.vertices.capacity() * sizeof(GridPoint) +
         curtains_.facets.capacity() * sizeof(curtains_.facets[0]) +
         (curtain_tree_ ? curtain_tree_->bytes() : 0);
}

}  // namespace tubefoot
