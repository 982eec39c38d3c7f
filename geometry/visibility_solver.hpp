// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <vector>

#include "geometry/cone_clip.hpp"
#include "geometry/facet_cone.hpp"
#include "geometry/gnomonic_frame.hpp"
#include "geometry/layer_grid.hpp"
#include "geometry/neighbours.hpp"
#include "geometry/reused_list.hpp"
#include "geometry/visibility.hpp"

// The visibility algorithm, once for all arithmetics; instantiated in visibility_<arithmetic>.cpp.
// Steps and their proofs: docs/visibility.md.
namespace tubefoot {

template <class A>
class VisibilitySolver {
 public:
  /// One thread's work on one tube. The solver is reused from tube to tube and keeps its buffers.
  void run(const A& arithmetic, const FacetMesh& mesh, GridPoint apex, const std::vector<FacetId>& candidates,
           const std::vector<FacetId>& hidden, const VisibilityOptions& options, TubeVisibility& out) {
    arithmetic_ = arithmetic;
    mesh_ = &mesh;
    options_ = options;
    out_ = &out;
    buffer_.clear();
    walls_.clear();
    frame_ = GnomonicFrame({out.rays[0], out.rays[1], out.rays[2], out.rays[3]});
    tube_ = make_tube_cone();
    facets_.clear();
    gather(apex, candidates);
    out.candidates = facets_.size();
    find_layers();
    const std::size_t mark = buffer_.size();
    for (std::uint32_t f = 0; f < facets_.size(); ++f) {
      see_facet(f);
      buffer_.resize(mark);
    }
    if (options_.open_water) {
      gather(apex, hidden);
      find_open_water();
    }
  }

 private:
  enum class Hides { no, where_covered, where_nearer };

  struct Occluder {
    std::uint32_t facet;
    Hides how;
  };

  /// Planes of a facet, made when first needed: most facets never are.
  struct FacetPlanes {
    bool made = false;
    typename A::Facet facet;
    std::array<ClipPlane<A>, 3> edges;
    std::array<Half<A>, 3> halves;
  };

  /// Halvings of a facet's bounds, at most: below that integer rays no longer tell the halves apart.
  static constexpr int deepest_split = 40;

  ClipPlane<A> plane_through(PointId a, GridPoint pa, PointId b, GridPoint pb) const {
    ClipPlane<A> plane;
    if (a > b) {
      std::swap(a, b);
      std::swap(pa, pb);
    }
    plane.name = {a, b, false};
    plane.points[0] = pa;
    plane.points[1] = pb;
    arithmetic_.through(plane.plane, pa, pb);
    return plane;
  }

  Half<A> wall(PointId a, PointId b) {
    ClipPlane<A>& plane = walls_.next();
    plane = plane_through(a, out_->rays[a & ~ray_bit], b, out_->rays[b & ~ray_bit]);
    return {&plane, a < b ? 1 : -1};
  }

  PieceRange make_tube_cone() {
    for (std::uint32_t k = 0; k < 4; ++k) {
      const Half<A> edge = wall(ray_bit | k, ray_bit | (k + 1) % 4);
      buffer_.push_back(point_corner(arithmetic_, ray_bit | k, out_->rays[k], edge));
    }
    return {0, 4};
  }

  void gather(GridPoint apex, const std::vector<FacetId>& candidates) {
    const std::size_t first = facets_.size();
    walls_cut_.resize(first);
    for (const FacetId id : candidates) {
      SeenFacet& facet = facets_.emplace_back();
      std::uint8_t walls = 0;
      if (FacetCone::make(*mesh_, id, apex, facet.cone) && enters_tube(facet.cone, walls)) {
        facet.measure(frame_);
        walls_cut_.push_back(walls);
      } else {
        facets_.pop_back();
      }
    }
    if (planes_.size() < facets_.size()) planes_.resize(facets_.size());
    for (std::size_t f = first; f < facets_.size(); ++f) planes_[f].made = false;
  }

  /// False if some wall of the tube has no vertex strictly inside; else `walls` has a bit for each wall that
  /// has a vertex outside. Exact.
  bool enters_tube(const FacetCone& cone, std::uint8_t& walls) const {
    for (int w = 0; w < 4; ++w) {
      const Half<A> half = buffer_[w].edge;
      bool inside = false;
      for (const GridPoint& p : cone.point) {
        const int s = half.sign * arithmetic_.side(p, half.plane->plane);
        inside |= s > 0;
        if (s < 0) walls = static_cast<std::uint8_t>(walls | 1u << w);
      }
      if (!inside) return false;
    }
    return true;
  }

  bool is_inside(Half<A> half, GridPoint p) const {
    return half.sign * arithmetic_.side(p, half.plane->plane) > 0;
  }

  const FacetPlanes& planes_of(std::uint32_t f) {
    FacetPlanes& planes = planes_[f];
    if (planes.made) return planes;
    planes.made = true;
    const FacetCone& cone = facets_[f].cone;
    arithmetic_.facet(planes.facet, cone);
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      planes.edges[k] = plane_through(cone.vertex[k], cone.point[k], cone.vertex[next], cone.point[next]);
      planes.halves[k] = {&planes.edges[k], cone.vertex[k] < cone.vertex[next] ? 1 : -1};
    }
    return planes;
  }

  void find_layers() {
    neighbour_finder_.find(
        facets_, neighbours_,
        [this](std::uint32_t f, std::uint32_t k, std::uint32_t g) {
          // f lies on the positive side of its edge's plane; g must lie on the other.
          const FacetCone &cone = facets_[f].cone, &other = facets_[g].cone;
          typename A::Plane plane;
          arithmetic_.through(plane, cone.point[k], cone.point[(k + 1) % 3]);
          for (int v = 0; v < 3; ++v)
            if (other.vertex[v] != cone.vertex[k] && other.vertex[v] != cone.vertex[(k + 1) % 3])
              return arithmetic_.side(other.point[v], plane) < 0;
          return false;
        },
        [this](std::uint32_t f, std::uint32_t k) {
          const FacetCone& cone = facets_[f].cone;
          for (int w = 0; w < 4; ++w) {
            const Half<A> half = buffer_[w].edge;
            if (!is_inside(half, cone.point[k]) && !is_inside(half, cone.point[(k + 1) % 3])) return true;
          }
          return false;
        });
    grid_.build(frame_, facets_, neighbours_);
  }

  /// The facet's cone within the tube; false if nothing with an interior is left.
  bool facet_in_tube(std::uint32_t f, PieceRange& piece) {
    const FacetCone& cone = facets_[f].cone;
    const FacetPlanes& planes = planes_of(f);
    piece = {static_cast<std::uint32_t>(buffer_.size()), 3};
    for (int k = 0; k < 3; ++k)
      buffer_.push_back(point_corner(arithmetic_, cone.vertex[k], cone.point[k], planes.halves[k]));
    for (std::uint32_t w = 0; w < tube_.count; ++w)
      if (walls_cut_[f] >> w & 1u)
        if (!clip_to(piece, Half<A>(buffer_[tube_.first + w].edge))) return false;
    return true;
  }

  void see_facet(std::uint32_t f) {
    PieceRange piece;
    if (grid_.is_hidden(f) || !facet_in_tube(f, piece)) return;
    // Only facets that can hide some of it are worth a cut.
    grid_.occluder_candidates(f, candidates_);
    list_.clear();
    for (const std::uint32_t o : candidates_)
      if (!surely_apart(facets_[f], facets_[o]))
        if (const Hides how = hides(f, o); how != Hides::no) list_.push_back({o, how});
    depth_planes_.clear();
    const auto first_occluder = static_cast<std::ptrdiff_t>(out_->occluders.size());
    receiver_ = f;
    const Bounds tube = frame_.tube(), own = facets_[f].bounds;
    carve(piece, 0, list_.size(),
          {std::max(tube.x0, own.x0), std::min(tube.x1, own.x1), std::max(tube.y0, own.y0),
           std::min(tube.y1, own.y1)},
          0);
    const auto begin = out_->occluders.begin() + first_occluder;
    std::sort(begin, out_->occluders.end());
    out_->occluders.erase(std::unique(begin, out_->occluders.end()), out_->occluders.end());
  }

  /// What no facet covers, found without regard to depth or to what else was found: the closure law's other
  /// half.
  void find_open_water() {
    receiver_ = nobody;
    list_.clear();
    for (std::uint32_t f = 0; f < facets_.size(); ++f) list_.push_back({f, Hides::where_covered});
    carve(tube_, 0, list_.size(), frame_.tube(), 0);
  }

  /// Takes the facets list_[begin, end) away from a piece, or, if they are many and lie apart, from its two
  /// halves separately: a large facet behind many small ones would otherwise be cut up across its whole width
  /// again and again.
  void carve(PieceRange piece, std::size_t begin, std::size_t end, Bounds box, int depth) {
    if (end - begin > options_.facets_per_split && depth < deepest_split && box.is_finite() &&
        split(piece, begin, end, box, depth))
      return;
    pieces_.assign(1, piece);
    for (std::size_t k = begin; k < end && !pieces_.empty(); ++k) {
      const auto [o, how] = list_[k];
      const FacetPlanes& planes = planes_of(o);
      std::array<Half<A>, 4> halves{planes.halves[0], planes.halves[1], planes.halves[2], Half<A>{}};
      int count = 3;
      if (how == Hides::where_nearer) {
        ClipPlane<A>& plane = depth_planes_.next();
        plane.name = {facets_[receiver_].cone.id, facets_[o].cone.id, true};
        arithmetic_.depth(plane.plane, planes_of(receiver_).facet, planes.facet);
        halves[count++] = {&plane, 1};
      }
      if (take_away(facets_[o], halves.data(), count) && receiver_ != nobody)
        out_->occluders.emplace_back(facets_[receiver_].cone.id, facets_[o].cone.id);
    }
    for (const PieceRange& left : pieces_)
      emit(receiver_ == nobody ? out_->open : out_->pieces,
           receiver_ == nobody ? no_point : facets_[receiver_].cone.id, left);
  }

  bool split(PieceRange piece, std::size_t begin, std::size_t end, Bounds box, int depth) {
    const std::size_t corner_mark = buffer_.size(), list_mark = list_.size(), ray_mark = out_->rays.size();
    const bool across = box.x1 - box.x0 >= box.y1 - box.y0;
    const double xm = (box.x0 + box.x1) / 2, ym = (box.y0 + box.y1) / 2;
    const auto ray = [&](double x, double y) {
      out_->rays.push_back(integer_ray(frame_.direction({x, y})));
      return ray_bit | static_cast<PointId>(out_->rays.size() - 1);
    };
    const PointId a = across ? ray(xm, box.y0) : ray(box.x0, ym),
                  b = across ? ray(xm, box.y1) : ray(box.x1, ym);
    const auto undo = [&] {
      buffer_.resize(corner_mark);
      list_.resize(list_mark);
      out_->rays.resize(ray_mark);
      return false;
    };
    if (out_->rays[a & ~ray_bit] == out_->rays[b & ~ray_bit]) return undo();
    const Half<A> half = wall(a, b), other{half.plane, -half.sign};

    where_.clear();
    std::size_t positive = 0, negative = 0;
    for (std::size_t k = begin; k < end; ++k) {
      unsigned mask = 0;
      for (const GridPoint& p : facets_[list_[k].facet].cone.point) {
        const int s = half.sign * arithmetic_.side(p, half.plane->plane);
        mask |= s > 0 ? 1u : s < 0 ? 2u : 0u;
      }
      where_.push_back(static_cast<std::uint8_t>(mask));
      positive += mask & 1;
      negative += mask >> 1;
    }
    // Facets that pile up in the same place are not set apart by splitting: clip them where they are.
    const std::size_t count = end - begin;
    if (positive + negative > count * 3 / 2 && std::max(positive, negative) > count * 9 / 10) return undo();
    if (sides_of(piece, half) != 3) return undo();
    flip_sides();
    const PieceRange first = clip(arithmetic_, buffer_, piece, half, sides_.data());
    const PieceRange second = clip(arithmetic_, buffer_, piece, other, flipped_.data());
    for (std::size_t k = 0; k < count; ++k)
      if (where_[k] & 1) list_.push_back(Occluder(list_[begin + k]));
    const std::size_t middle = list_.size();
    for (std::size_t k = 0; k < count; ++k)
      if (where_[k] & 2) list_.push_back(Occluder(list_[begin + k]));
    const std::size_t last = list_.size();

    Bounds low = box, high = box;
    (across ? low.x1 : low.y1) = (across ? high.x0 : high.y0) = across ? xm : ym;
    const bool first_is_low = positive_is_low(half, across, xm, ym, box);
    carve(first, list_mark, middle, first_is_low ? low : high, depth + 1);
    carve(second, middle, last, first_is_low ? high : low, depth + 1);
    buffer_.resize(corner_mark);
    list_.resize(list_mark);
    return true;
  }

  /// On which half of the box the split plane's positive side lies: tells the children's boxes apart, no
  /// more.
  bool positive_is_low(Half<A> half, bool across, double xm, double ym, const Bounds& box) const {
    const double x = across ? (box.x0 + xm) / 2 : xm, y = across ? ym : (box.y0 + ym) / 2;
    return half.sign * arithmetic_.side(integer_ray(frame_.direction({x, y})), half.plane->plane) > 0;
  }

  /// Fills sides_ with the side of each corner; returns 1 if any is positive, plus 2 if any is negative.
  int sides_of(PieceRange piece, Half<A> half) {
    if (sides_.size() < piece.count) sides_.resize(piece.count);
    int signs = 0;
    for (std::uint32_t k = 0; k < piece.count; ++k) {
      const int s = side(arithmetic_, buffer_[piece.first + k], half);
      sides_[k] = s;
      signs |= s > 0 ? 1 : s < 0 ? 2 : 0;
    }
    return signs;
  }

  void flip_sides() {
    if (flipped_.size() < sides_.size()) flipped_.resize(sides_.size());
    std::transform(sides_.begin(), sides_.end(), flipped_.begin(), [](int s) { return -s; });
  }

  /// Clips `piece` to `half`; false if nothing with an interior is left.
  bool clip_to(PieceRange& piece, Half<A> half) {
    const int signs = sides_of(piece, half);
    if (!(signs & 1)) return false;
    if (signs & 2) piece = clip(arithmetic_, buffer_, piece, half, sides_.data());
    return piece.count >= 3;
  }

  /// Which way `occluder` can hide `receiver`, from the sides of vertices alone: it hides where it covers,
  /// only on the near side of the depth plane, or not at all.
  Hides hides(std::uint32_t receiver, std::uint32_t occluder) {
    bool near = false, far = false;
    sort_vertices(receiver, occluder, near, far);
    if (!near && far) return Hides::no;
    if (!near)
      return wins_tie(*mesh_, facets_[occluder].cone.id, facets_[receiver].cone.id) ? Hides::where_covered
                                                                                    : Hides::no;
    if (!far) return Hides::where_covered;
    bool receiver_near = false, receiver_far = false;
    sort_vertices(occluder, receiver, receiver_near, receiver_far);
    if (!receiver_far) return Hides::no;
    return receiver_near ? Hides::where_nearer : Hides::where_covered;
  }

  /// Whether `facet` has vertices nearer and farther than the plane of `reference`.
  void sort_vertices(std::uint32_t reference, std::uint32_t facet, bool& near, bool& far) {
    const typename A::Facet& plane = planes_of(reference).facet;
    const FacetCone &own = facets_[reference].cone, &other = facets_[facet].cone;
    for (int k = 0; k < 3; ++k) {
      if constexpr (A::uses_names) {
        const auto& v = own.vertex;
        const VertexId id = other.vertex[k];
        if (id == v[0] || id == v[1] || id == v[2]) continue;
      }
      const int s = arithmetic_.nearer(plane, other.point[k]);
      near |= s > 0;
      far |= s < 0;
    }
  }

  /// Replaces pieces_ by what is left of them outside of the cone of the halves; true if anything was taken.
  bool take_away(const SeenFacet& facet, const Half<A>* halves, int half_count) {
    bool taken = false;
    kept_.clear();
    for (const PieceRange& piece : pieces_) taken |= take_away(piece, facet, halves, half_count);
    pieces_.swap(kept_);
    return taken;
  }

  bool take_away(PieceRange piece, const SeenFacet& facet, const Half<A>* halves, int half_count) {
    std::array<Half<A>, 4> cutting;
    int cuts = 0;
    for (int h = 0; h < half_count; ++h) {
      const int signs = sides_of(piece, halves[h]);
      if (!(signs & 1)) {  // wholly outside
        kept_.push_back(piece);
        return false;
      }
      if (!(signs & 2)) continue;
      if (cuts == 0) sides_.swap(first_sides_);
      cutting[cuts++] = halves[h];
    }
    // Two convex cones in one half-space with disjoint interiors are set apart by an edge plane of one of
    // them; without this test the piece would be cut up for nothing.
    for (std::uint32_t k = 0; cuts > 0 && k < piece.count; ++k) {
      const Half<A> edge = buffer_[piece.first + k].edge;
      if (!any_vertex_inside(facet, edge)) {
        kept_.push_back(piece);
        return false;
      }
    }
    const std::size_t mark = buffer_.size(), kept_mark = kept_.size();
    PieceRange rest = piece;
    for (int h = 0; h < cuts; ++h) {
      if (h == 0) sides_.swap(first_sides_);
      const int signs = h == 0 ? 3 : sides_of(rest, cutting[h]);
      if (!(signs &
            1)) {  // they do not meet after all (set apart by a depth plane, or by the apex): undo the cuts
        buffer_.resize(mark);
        kept_.resize(kept_mark);
        kept_.push_back(piece);
        return false;
      }
      if (!(signs & 2)) continue;
      flip_sides();
      const PieceRange outside =
          clip(arithmetic_, buffer_, rest, Half<A>{cutting[h].plane, -cutting[h].sign}, flipped_.data());
      if (outside.count >= 3) kept_.push_back(outside);
      rest = clip(arithmetic_, buffer_, rest, cutting[h], sides_.data());
    }
    return true;
  }

  bool any_vertex_inside(const SeenFacet& facet, Half<A> half) const {
    for (int k = 0; k < 3; ++k) {
      if constexpr (A::uses_names)
        if (half.plane->name.contains(facet.cone.vertex[k])) continue;
      if (half.sign * arithmetic_.side(facet.cone.point[k], half.plane->plane) > 0) return true;
    }
    return false;
  }

  void emit(std::vector<NamedPiece>& pieces, FacetId facet, PieceRange piece) {
    pieces.push_back({facet, static_cast<std::uint32_t>(out_->corners.size()), piece.count});
    for (std::uint32_t k = 0; k < piece.count; ++k) {
      const ClipCorner<A>& c = buffer_[piece.first + k];
      CornerName name;
      name.point = c.point;
      if (c.point == no_point) {
        name.p = c.p.plane->name;
        name.q = c.q.plane->name;
        name.sign = c.p.sign * c.q.sign;
      }
      out_->corners.push_back(name);
    }
  }

  static constexpr std::uint32_t nobody = 0xffffffffu;

  A arithmetic_{};
  const FacetMesh* mesh_ = nullptr;
  VisibilityOptions options_;
  TubeVisibility* out_ = nullptr;
  GnomonicFrame frame_;
  PieceRange tube_;
  std::uint32_t receiver_ = nobody;  ///< facet at hand; nobody: open water
  std::vector<SeenFacet> facets_;
  std::vector<std::uint8_t> walls_cut_;  ///< by facet: a bit for each wall of the tube that it reaches beyond
  std::deque<FacetPlanes> planes_;       ///< by facet; a deque, because halves point into it
  std::vector<Neighbours> neighbours_;
  NeighbourFinder neighbour_finder_;
  LayerGrid grid_;
  std::vector<std::uint32_t> candidates_;
  std::vector<Occluder> list_;
  CornerBuffer<A> buffer_;
  ReusedList<ClipPlane<A>> walls_, depth_planes_;
  std::vector<PieceRange> pieces_, kept_;
  std::vector<int> sides_, first_sides_, flipped_;
  std::vector<std::uint8_t>
      where_;  ///< per listed facet: 1 on the positive side of a split, 2 on the negative
};

}  // namespace tubefoot
