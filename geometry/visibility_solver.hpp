// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <glm/glm.hpp>
#include <limits>
#include <numeric>
#include <vector>

#include "geometry/cone_clip.hpp"
#include "geometry/facet_cone.hpp"
#include "geometry/visibility.hpp"

// The visibility algorithm, once for all arithmetics; instantiated in visibility_<arithmetic>.cpp.
// Steps and their proofs: docs/visibility.md.
namespace tubefoot {

inline glm::dvec3 as_double(GridPoint p) { return {p.x, p.y, p.z}; }

template <class A>
class VisibilitySolver {
 public:
  /// One thread's work on one tube. The solver is reused from tube to tube and keeps its buffers.
  void run(const A& arithmetic, const FacetMesh& mesh, GridPoint apex, const std::vector<FacetId>& candidates,
           const VisibilityOptions& options, TubeVisibility& out) {
    arithmetic_ = arithmetic;
    mesh_ = &mesh;
    options_ = options;
    out_ = &out;
    buffer_.clear();
    walls_.clear();
    depth_planes_.clear();
    make_tile_frame();
    const PieceRange tile = make_tube_cone();
    gather(apex, candidates);
    list_.resize(facets_.size());
    std::iota(list_.begin(), list_.end(), 0u);
    out.candidates = facets_.size();
    solve(tile, 0, list_.size(), box_, 0);
    std::sort(out.pieces.begin(), out.pieces.end(), [](const NamedPiece& a, const NamedPiece& b) {
      return a.facet != b.facet ? a.facet < b.facet : a.first < b.first;
    });
    std::sort(out.occluders.begin(), out.occluders.end());
    out.occluders.erase(std::unique(out.occluders.begin(), out.occluders.end()), out.occluders.end());
  }

 private:
  /// Bounds in the tube's gnomonic plane, in double and a little too wide: a filter, never a verdict.
  struct Bounds {
    double x0, x1, y0, y1;
    bool meets(const Bounds& o) const { return x0 <= o.x1 && o.x0 <= x1 && y0 <= o.y1 && o.y0 <= y1; }
  };

  struct SeenFacet {
    FacetCone cone;
    typename A::Facet plane;
    std::array<ClipPlane<A>, 3> edges;
    std::array<Half<A>, 3> halves;
    Bounds bounds;
    double nearest, farthest;  ///< bounds on its distance from the apex, grid units
  };

  enum class Hides { no, where_covered, where_nearer };

  static constexpr int deepest_split = 40;
  static constexpr double shallowest =
      1e-3;  ///< sine of the least angle to the horizon of the gnomonic plane

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
    walls_.push_back(plane_through(a, out_->rays[a & ~ray_bit], b, out_->rays[b & ~ray_bit]));
    return {&walls_.back(), a < b ? 1 : -1};
  }

  void make_tile_frame() {
    glm::dvec3 sum{0};
    for (int k = 0; k < 4; ++k) sum += glm::normalize(as_double(out_->rays[k]));
    axis_ = glm::normalize(sum);
    right_ = glm::normalize(as_double(out_->rays[1]) - as_double(out_->rays[0]));
    right_ = glm::normalize(right_ - axis_ * glm::dot(right_, axis_));
    up_ = glm::cross(axis_, right_);
    constexpr double inf = std::numeric_limits<double>::infinity();
    box_ = {inf, -inf, inf, -inf};
    for (int k = 0; k < 4; ++k) {
      const glm::dvec3 d = glm::normalize(as_double(out_->rays[k]));
      const double depth = glm::dot(d, axis_);
      if (depth < shallowest) {  // too wide a tube for a gnomonic plane: never split
        box_ = {-inf, inf, -inf, inf};
        return;
      }
      const double x = glm::dot(d, right_) / depth, y = glm::dot(d, up_) / depth;
      box_ = {std::min(box_.x0, x), std::max(box_.x1, x), std::min(box_.y0, y), std::max(box_.y1, y)};
    }
  }

  PieceRange make_tube_cone() {
    for (std::uint32_t k = 0; k < 4; ++k) {
      const Half<A> edge = wall(ray_bit | k, ray_bit | (k + 1) % 4);
      buffer_.push_back(point_corner(arithmetic_, ray_bit | k, out_->rays[k], edge));
    }
    return {0, 4};
  }

  Bounds bounds_of(const FacetCone& cone) const {
    constexpr double inf = std::numeric_limits<double>::infinity();
    Bounds b{inf, -inf, inf, -inf};
    for (const GridPoint& p : cone.point) {
      const glm::dvec3 d = as_double(p);
      const double depth = glm::dot(d, axis_);
      // Beyond 89.9 degrees from the axis the gnomonic plane says nothing: such a facet meets everything.
      if (depth < shallowest * glm::length(d)) return {-inf, inf, -inf, inf};
      const double x = glm::dot(d, right_) / depth, y = glm::dot(d, up_) / depth;
      // Rounding of x is below 1e-12 (1 + |x|): |d| / depth <= 1000.
      const double ex = 1e-12 * (1 + std::abs(x)), ey = 1e-12 * (1 + std::abs(y));
      b = {std::min(b.x0, x - ex), std::max(b.x1, x + ex), std::min(b.y0, y - ey), std::max(b.y1, y + ey)};
    }
    return b;
  }

  void gather(GridPoint apex, const std::vector<FacetId>& candidates) {
    facets_.clear();
    facets_.reserve(candidates.size());  // halves point into facets_: it must not move
    for (const FacetId id : candidates) {
      SeenFacet& f = facets_.emplace_back();
      if (!FacetCone::make(*mesh_, id, apex, f.cone) || outside_tube(f.cone)) {
        facets_.pop_back();
        continue;
      }
      const FacetCone& cone = f.cone;
      f.bounds = bounds_of(cone);
      std::array<double, 3> distance;
      for (int k = 0; k < 3; ++k) distance[k] = glm::length(as_double(cone.point[k]));
      const auto [low, high] = std::minmax_element(distance.begin(), distance.end());
      double longest = 0;
      for (int k = 0; k < 3; ++k)
        longest =
            std::max(longest, glm::length(as_double(cone.point[k]) - as_double(cone.point[(k + 1) % 3])));
      // No point of a triangle is farther than its longest side / sqrt(3) from a vertex; nor nearer than its
      // plane.
      const double plane_distance = static_cast<double>(cone.offset) /
                                    glm::length(glm::dvec3(cone.normal.x, cone.normal.y, cone.normal.z));
      f.nearest = std::max(*low - 0.57736 * longest, plane_distance) * (1 - 1e-12);
      f.farthest = *high * (1 + 1e-12);
    }
    order_.resize(facets_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::sort(order_.begin(), order_.end(), [this](std::uint32_t a, std::uint32_t b) {
      return facets_[a].nearest != facets_[b].nearest ? facets_[a].nearest < facets_[b].nearest
                                                      : facets_[a].cone.id < facets_[b].cone.id;
    });
    sorted_.clear();
    sorted_.reserve(facets_.size());
    for (const std::uint32_t k : order_) sorted_.push_back(facets_[k]);
    facets_.swap(sorted_);
    for (SeenFacet& f : facets_) {
      arithmetic_.facet(f.plane, f.cone);
      for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        f.edges[k] =
            plane_through(f.cone.vertex[k], f.cone.point[k], f.cone.vertex[next], f.cone.point[next]);
        f.halves[k] = {&f.edges[k], f.cone.vertex[k] < f.cone.vertex[next] ? 1 : -1};
      }
    }
  }

  /// Exact: some wall of the tube has no vertex strictly inside.
  bool outside_tube(const FacetCone& cone) const {
    for (int w = 0; w < 4; ++w) {
      const Half<A> half = buffer_[w].edge;
      bool inside = false;
      for (int k = 0; k < 3 && !inside; ++k)
        inside = half.sign * arithmetic_.side(cone.point[k], half.plane->plane) > 0;
      if (!inside) return true;
    }
    return false;
  }

  /// Splits the tile while it holds many facets and splitting sets some of them apart, then clips.
  void solve(PieceRange tile, std::size_t begin, std::size_t end, Bounds box, int depth) {
    if (end - begin > options_.facets_per_split && depth < deepest_split && std::isfinite(box.x0) &&
        split(tile, begin, end, box, depth))
      return;
    see_tile(tile, begin, end);
  }

  bool split(PieceRange tile, std::size_t begin, std::size_t end, Bounds box, int depth) {
    const std::size_t corner_mark = buffer_.size(), list_mark = list_.size(), ray_mark = out_->rays.size();
    const bool across = box.x1 - box.x0 >= box.y1 - box.y0;
    const double xm = (box.x0 + box.x1) / 2, ym = (box.y0 + box.y1) / 2;
    const auto ray = [&](double x, double y) {
      out_->rays.push_back(integer_ray(glm::normalize(axis_ + x * right_ + y * up_)));
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
      for (const GridPoint& p : facets_[list_[k]].cone.point) {
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
    if (sides_of(tile, half) != 3) return undo();
    flip_sides();
    const PieceRange first = clip(arithmetic_, buffer_, tile, half, sides_.data());
    const PieceRange second = clip(arithmetic_, buffer_, tile, other, flipped_.data());
    for (std::size_t k = 0; k < count; ++k)
      if (where_[k] & 1) list_.push_back(std::uint32_t(list_[begin + k]));
    const std::size_t middle = list_.size();
    for (std::size_t k = 0; k < count; ++k)
      if (where_[k] & 2) list_.push_back(std::uint32_t(list_[begin + k]));
    const std::size_t last = list_.size();

    Bounds low = box, high = box;
    (across ? low.x1 : low.y1) = (across ? high.x0 : high.y0) = across ? xm : ym;
    const bool first_is_low = positive_is_low(half, across, xm, ym, box);
    solve(first, list_mark, middle, first_is_low ? low : high, depth + 1);
    solve(second, middle, last, first_is_low ? high : low, depth + 1);
    buffer_.resize(corner_mark);
    list_.resize(list_mark);
    return true;
  }

  /// On which half of the box the split plane's positive side lies: tells the children's boxes apart, no
  /// more.
  bool positive_is_low(Half<A> half, bool across, double xm, double ym, const Bounds& box) const {
    const double x = across ? (box.x0 + xm) / 2 : xm, y = across ? ym : (box.y0 + ym) / 2;
    return half.sign * arithmetic_.side(integer_ray(glm::normalize(axis_ + x * right_ + y * up_)),
                                        half.plane->plane) >
           0;
  }

  /// Fills sides_ with the side of each corner; returns 1 if any is positive, plus 2 if any is negative.
  int sides_of(PieceRange piece, Half<A> half) {
    sides_.resize(piece.count);
    int signs = 0;
    for (std::uint32_t k = 0; k < piece.count; ++k) {
      const int s = side(arithmetic_, buffer_[piece.first + k], half);
      sides_[k] = s;
      signs |= s > 0 ? 1 : s < 0 ? 2 : 0;
    }
    return signs;
  }

  void flip_sides() {
    flipped_.resize(sides_.size());
    std::transform(sides_.begin(), sides_.end(), flipped_.begin(), [](int s) { return -s; });
  }

  /// Clips `piece` to `half`; false if nothing with an interior is left.
  bool clip_to(PieceRange& piece, Half<A> half) {
    const int signs = sides_of(piece, half);
    if (!(signs & 1)) return false;
    if (signs & 2) piece = clip(arithmetic_, buffer_, piece, half, sides_.data());
    return piece.count >= 3;
  }

  void see_tile(PieceRange tile, std::size_t begin, std::size_t end) {
    const std::size_t mark = buffer_.size();
    for (std::size_t k = begin; k < end; ++k) {
      see_facet(tile, facets_[list_[k]], begin, end);
      buffer_.resize(mark);
    }
    if (!options_.open_water) return;
    pieces_.assign(1, tile);
    for (std::size_t k = begin; k < end && !pieces_.empty(); ++k) {
      const SeenFacet& f = facets_[list_[k]];
      take_away(f, f.halves.data(), 3);
    }
    for (const PieceRange& piece : pieces_) emit(out_->open, no_point, piece);
    buffer_.resize(mark);
  }

  void see_facet(PieceRange tile, const SeenFacet& receiver, std::size_t begin, std::size_t end) {
    PieceRange piece{static_cast<std::uint32_t>(buffer_.size()), 3};
    for (int k = 0; k < 3; ++k)
      buffer_.push_back(
          point_corner(arithmetic_, receiver.cone.vertex[k], receiver.cone.point[k], receiver.halves[k]));
    for (std::uint32_t k = 0; k < tile.count; ++k)
      if (!clip_to(piece, Half<A>(buffer_[tile.first + k].edge))) return;
    pieces_.assign(1, piece);
    depth_planes_.clear();
    for (std::size_t k = begin; k < end; ++k) {
      const SeenFacet& occluder = facets_[list_[k]];
      if (occluder.nearest >= receiver.farthest) break;  // sorted by `nearest`: none of the rest can hide
      if (&occluder == &receiver || !occluder.bounds.meets(receiver.bounds)) continue;
      std::array<Half<A>, 4> halves{occluder.halves[0], occluder.halves[1], occluder.halves[2], Half<A>{}};
      int count = 3;
      switch (hides(receiver, occluder)) {
        case Hides::no:
          continue;
        case Hides::where_covered:
          break;
        case Hides::where_nearer: {
          ClipPlane<A>& plane = depth_planes_.emplace_back();
          plane.name = {receiver.cone.id, occluder.cone.id, true};
          arithmetic_.depth(plane.plane, receiver.plane, occluder.plane);
          halves[count++] = {&plane, 1};
        }
      }
      if (take_away(occluder, halves.data(), count)) {
        out_->occluders.emplace_back(receiver.cone.id, occluder.cone.id);
        if (pieces_.empty()) return;
      }
    }
    for (const PieceRange& visible : pieces_) emit(out_->pieces, receiver.cone.id, visible);
  }

  /// Which way `occluder` can hide `receiver`, from the sides of vertices alone: it hides where it covers,
  /// only on the near side of the depth plane, or not at all.
  Hides hides(const SeenFacet& receiver, const SeenFacet& occluder) const {
    bool near = false, far = false;
    sort_vertices(receiver, occluder, near, far);
    if (!near && far) return Hides::no;
    if (!near) return wins_tie(*mesh_, occluder.cone.id, receiver.cone.id) ? Hides::where_covered : Hides::no;
    if (!far) return Hides::where_covered;
    bool receiver_near = false, receiver_far = false;
    sort_vertices(occluder, receiver, receiver_near, receiver_far);
    if (!receiver_far) return Hides::no;
    return receiver_near ? Hides::where_nearer : Hides::where_covered;
  }

  /// Whether `facet` has vertices nearer and farther than the plane of `reference`.
  void sort_vertices(const SeenFacet& reference, const SeenFacet& facet, bool& near, bool& far) const {
    for (int k = 0; k < 3; ++k) {
      if constexpr (A::uses_names) {
        const auto& v = reference.cone.vertex;
        const VertexId id = facet.cone.vertex[k];
        if (id == v[0] || id == v[1] || id == v[2]) continue;
      }
      const int s = arithmetic_.nearer(reference.plane, facet.cone.point[k]);
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
      if (signs & 2) cutting[cuts++] = halves[h];
    }
    // Two convex cones with disjoint interiors are set apart by an edge plane of one of them; without this
    // test the piece would be cut up for nothing.
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
      const int signs = sides_of(rest, cutting[h]);
      if (!(signs & 1)) {  // they do not meet after all (a depth plane set them apart): undo the cuts
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

  A arithmetic_{};
  const FacetMesh* mesh_ = nullptr;
  VisibilityOptions options_;
  TubeVisibility* out_ = nullptr;
  glm::dvec3 axis_{}, right_{}, up_{};
  Bounds box_{};
  std::vector<SeenFacet> facets_, sorted_;
  std::vector<std::uint32_t> order_, list_;
  CornerBuffer<A> buffer_;
  std::deque<ClipPlane<A>> walls_, depth_planes_;
  std::vector<PieceRange> pieces_, kept_;
  std::vector<int> sides_, flipped_;
  std::vector<std::uint8_t>
      where_;  ///< per facet of a tile: 1 on the positive side of the split, 2 on the negative
};

}  // namespace tubefoot
