// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/arithmetic/cone_clip.hpp"
#include "geometry/mesh/facet_cone.hpp"
#include "geometry/steps/reused_list.hpp"
#include "geometry/steps/stop.hpp"
#include "geometry/visibility/candidate_facets.hpp"
#include "geometry/visibility/gnomonic_frame.hpp"
#include "geometry/visibility/layer_grid.hpp"
#include "geometry/visibility/piece_divider.hpp"
#include "geometry/visibility/visibility.hpp"

// Computes the visible pieces of a pyramid of tubes, as one template for all arithmetics. It is instantiated
// in visibility_<arithmetic>.cpp. For each facet that is not certainly hidden, the solver finds the facets
// that may hide it and subtracts their cones. Depth planes bound these cones where two facets interpenetrate.
// The page docs/notes/visibility.md describes the steps and their proofs.
namespace tubefoot {

template <class A>
class VisibilitySolver : PieceDivider<A> {
 public:
  /// Starts one thread's work on the tubes of `candidate_facets`, which must outlive this work. The solver is
  /// reused from tube to tube and keeps its buffers.
  void begin(const FacetMesh& mesh, GridPoint apex, CandidateFacets& candidate_facets) {
    mesh_ = &mesh;
    apex_ = apex;
    candidate_facets_ = &candidate_facets;
  }

  /// Computes the tubes of a run.
  void run(const A& arithmetic, const VisibilityOptions& options, const TubesInPyramid& tubes,
           std::span<TubeVisibility> out) {
    arithmetic_ = arithmetic;
    options_ = options;
    buffer_.clear();
    walls_.clear();
    this->begin_tubes(tubes, out);
    make_pyramid_cone();
    gather(tubes.pyramid);
    out.front().candidates = facets_.size();
    find_layers();
    const std::size_t mark = buffer_.size();
    for (std::uint32_t f = 0; f < facets_.size(); ++f) {
      stop_if_wanted();
      see_facet(f);
      buffer_.resize(mark);
    }
    if (options_.open_water) {
      gather_hidden();
      find_open_water();
    }
    this->end_tubes();
  }

 private:
  using Base = PieceDivider<A>;
  using Base::arithmetic_, Base::buffer_, Base::left_, Base::sides_, Base::flipped_, Base::has_lanes;
  using Base::frame_, Base::pyramid_, Base::first_ray_, Base::removed_;
  using Base::sides_of, Base::flip_sides, Base::clip_to, Base::take_away, Base::plane_through, Base::ray;
  using typename Base::FourHalves, typename Base::WallSides;

  enum class Hides { no, where_covered, where_nearer };

  struct Occluder {
    std::uint32_t facet;
    Hides how;
  };

  /// Planes of a facet, computed when they are first needed. Most facets never need them.
  struct FacetPlanes {
    typename A::Facet facet;
    std::array<ClipPlane<A>, 3> edges;
    std::array<Half<A>, 3> halves;
    const FourHalves* lanes;  ///< of the halves; null until they are needed
  };

  /// Maximum number of halvings of a facet's bounds. Smaller parts are not distinguishable with integer rays.
  static constexpr int deepest_split = 40;

  /// Number of facets on one edge beyond the first from which drop_covered() saves more time than it takes.
  static constexpr std::uint32_t crowd = 32;
  static constexpr std::size_t most_covering = 16;

  Half<A> wall(PointId a, PointId b) {
    ClipPlane<A>& plane = walls_.next();
    plane = plane_through(a, ray(a), b, ray(b));
    return {&plane, a < b ? 1 : -1};
  }

  void make_pyramid_cone() {
    for (std::uint32_t k = 0; k < 4; ++k) {
      const PointId id = ray_bit | (first_ray_ + k);
      point_corner(arithmetic_, id, ray(id), pyramid_.halves[k], buffer_.emplace_back());
    }
  }

  /// Selects the pyramid's facets from the candidate facets.
  void gather(const std::array<GridPoint, 4>& rays) {
    const auto inwards = [&](int k) { return CandidateFacets::Wall(cross(rays[k], rays[(k + 1) % 4])); };
    const std::array<CandidateFacets::Wall, 4> walls{inwards(0), inwards(1), inwards(2), inwards(3)};
    facets_.clear();
    gathered_.clear();
    sides_of_walls_.clear();
    const std::vector<RangedFacet>& all = candidate_facets_->facets();
    for (std::uint32_t f = 0; f < all.size(); ++f)
      if (WallSides sides;
          candidate_facets_->admits(f, walls) && this->enters(all[f].cone, pyramid_, sides)) {
        gathered_.push_back(f);
        add_facet(all[f], sides);
      }
    made_planes_.clear();
    lanes_.clear();
    planes_.assign(facets_.size(), nullptr);
  }

  void gather_hidden() {
    RangedFacet facet;
    for (const FacetId id : candidate_facets_->hidden())
      if (WallSides sides;
          FacetCone::make(*mesh_, id, apex_, facet.cone) && this->enters(facet.cone, pyramid_, sides)) {
        facet.measure_ranges();
        add_facet(facet, sides);
      }
    planes_.resize(facets_.size(), nullptr);
  }

  void add_facet(const RangedFacet& facet, WallSides sides) {
    facets_.emplace_back(facet).place(frame_);
    sides_of_walls_.push_back(sides);
  }

  FacetPlanes& planes_of(std::uint32_t f) {
    if (planes_[f]) return *planes_[f];
    FacetPlanes& planes = made_planes_.next();
    planes_[f] = &planes;
    planes.lanes = nullptr;
    const FacetCone& cone = facets_[f].cone;
    arithmetic_.facet(planes.facet, cone);
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      planes.edges[k] = plane_through(cone.vertex[k], cone.point[k], cone.vertex[next], cone.point[next]);
      planes.halves[k] = {&planes.edges[k], cone.vertex[k] < cone.vertex[next] ? 1 : -1};
    }
    return planes;
  }

  const FourHalves* lanes_of(FacetPlanes& planes) {
    if constexpr (has_lanes)
      if (!planes.lanes) {
        FourHalves& lanes = lanes_.next();
        for (std::size_t k = 0; k < 3; ++k) lanes.set(k, planes.edges[k].plane, planes.halves[k].sign);
        planes.lanes = &lanes;
      }
    return planes.lanes;
  }

  void find_layers() {
    candidate_facets_->find_neighbours(gathered_, crowd, neighbours_, crowded_);
    for (std::uint32_t f = 0; f < facets_.size(); ++f)
      for (std::uint32_t k = 0; k < 3; ++k)
        if (neighbours_[f][k] == silhouette && edge_is_outside(f, k)) neighbours_[f][k] = outside_tube;
    grid_.build(frame_, facets_, neighbours_);
  }

  bool edge_is_outside(std::uint32_t f, std::uint32_t k) const {
    const unsigned ends = 1u << k | 1u << (k + 1) % 3;
    for (unsigned w = 0; w < 4; ++w)
      if (!(sides_of_walls_[f].inside >> 3 * w & ends)) return true;
    return false;
  }

  PieceRange cone_of(std::uint32_t f) {
    const FacetCone& cone = facets_[f].cone;
    const FacetPlanes& planes = planes_of(f);
    const PieceRange piece{static_cast<std::uint32_t>(buffer_.size()), 3};
    for (int k = 0; k < 3; ++k)
      point_corner(arithmetic_, cone.vertex[k], cone.point[k], planes.halves[k], buffer_.emplace_back());
    return piece;
  }

  /// Computes the facet's cone within the pyramid. Returns false if nothing with an interior is left.
  bool facet_in_pyramid(std::uint32_t f, PieceRange& piece) {
    piece = cone_of(f);
    const WallSides& sides = sides_of_walls_[f];
    bool whole = true;
    for (std::uint32_t w = 0; w < 4; ++w) {
      const unsigned inside = sides.inside >> 3 * w & 7u, outside = sides.outside >> 3 * w & 7u;
      if (outside == 0) continue;
      const Half<A> wall = pyramid_.halves[w];
      if (whole) {
        std::array<int, 3> known;
        for (unsigned k = 0; k < 3; ++k) known[k] = int(inside >> k & 1u) - int(outside >> k & 1u);
        piece = clip(arithmetic_, buffer_, piece, wall, known.data());
        if (piece.count < 3) return false;
        whole = false;
      } else if (!clip_to(piece, wall)) {
        return false;
      }
    }
    return true;
  }

  void see_facet(std::uint32_t f) {
    if (grid_.is_hidden(f) || !this->find_tubes(facets_[f])) return;
    const FacetCone& cone = facets_[f].cone;
    const bool whole = sides_of_walls_[f].outside == 0;
    PieceRange piece;
    if (!whole && this->is_single() && !facet_in_pyramid(f, piece)) return;
    find_occluders(f);
    if (list_.empty()) {
      // This is the case for most facets of a seabed; it needs no planes unless a wall of a tube cuts.
      if (this->is_single() ? whole : this->is_whole_in_tubes()) return this->emit_whole(cone);
      return this->emit(cone.id, this->is_single() ? piece : cone_of(f));
    }
    if ((whole || !this->is_single()) && !facet_in_pyramid(f, piece)) return;
    depth_planes_.clear();
    target_ = f;
    const Bounds pyramid = frame_.tube(), own = facets_[f].bounds;
    carve(piece, 0, list_.size(),
          {std::max(pyramid.x0, own.x0), std::min(pyramid.x1, own.x1), std::max(pyramid.y0, own.y0),
           std::min(pyramid.y1, own.y1)},
          0);
    this->sort_occluders(cone.id);
  }

  /// Writes the facets that can hide a part of this facet to list_. Only these need to be subtracted.
  void find_occluders(std::uint32_t f) {
    grid_.occluder_candidates(f, candidates_);
    list_.clear();
    for (const std::uint32_t o : candidates_)
      if (const Hides how = hides(f, o); how != Hides::no) list_.push_back({o, how});
    if (crowded_[f]) drop_covered();
  }

  /// Removes facets from list_ that lie within the cone of another one that hides everything it covers. Only
  /// a few large facets are tested as covers; of thousands of facets around one edge they cover nearly all.
  /// The remaining facets hide the same region.
  void drop_covered() {
    const auto size = [this](std::uint32_t k) {
      const FramedFacet& facet = facets_[list_[k].facet];
      const Bounds& b = facet.bounds;
      return facet.placed ? (b.x1 - b.x0) * (b.y1 - b.y0) : -1;
    };
    largest_first_.resize(list_.size());
    for (std::uint32_t k = 0; k < list_.size(); ++k) largest_first_[k] = {size(k), k};
    std::sort(largest_first_.begin(), largest_first_.end(), [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    covered_.assign(list_.size(), 0);
    covering_.clear();
    for (const auto& [area, k] : largest_first_) {
      if (area < 0) break;  // a facet that extends behind the apex has no position in the plane
      const auto& [facet, how] = list_[k];
      covered_[k] = std::any_of(covering_.begin(), covering_.end(), [&, inner = facet](std::uint32_t outer) {
        return surely_covers(facets_[outer], facets_[inner]);
      });
      if (!covered_[k] && how == Hides::where_covered && covering_.size() < most_covering)
        covering_.push_back(facet);
    }
    std::size_t kept = 0;
    for (std::size_t k = 0; k < list_.size(); ++k)
      if (!covered_[k]) list_[kept++] = Occluder(list_[k]);
    list_.resize(kept);
  }

  /// Computes the unobstructed region, which no facet covers. The computation ignores depth and the visible
  /// pieces, so that it is an independent part of the closure law.
  void find_open_water() {
    target_ = none;
    list_.clear();
    for (std::uint32_t f = 0; f < facets_.size(); ++f) list_.push_back({f, Hides::where_covered});
    this->take_all_tubes();
    carve({0, 4}, 0, list_.size(), frame_.tube(), 0);
  }

  /// Subtracts the facets list_[begin, end) from a piece. If the facets are many and spread over the piece,
  /// the function processes the two halves of the piece separately. Otherwise a large facet behind many small
  /// ones would be cut across its whole width again and again.
  void carve(PieceRange piece, std::size_t begin, std::size_t end, Bounds box, int depth) {
    if (end - begin > options_.facets_per_split && depth < deepest_split && box.is_finite() &&
        split(piece, begin, end, box, depth))
      return;
    left_.begin(piece);
    removed_.clear();
    for (std::size_t k = begin; k < end && !left_.empty(); ++k) {
      stop_if_wanted();
      const auto [o, how] = list_[k];
      FacetPlanes& planes = planes_of(o);
      std::array<Half<A>, 4> halves{planes.halves[0], planes.halves[1], planes.halves[2], Half<A>{}};
      const FourHalves* lanes = lanes_of(planes);
      int count = 3;
      if (how == Hides::where_nearer) {
        ClipPlane<A>& plane = depth_planes_.next();
        plane.name = {facets_[target_].cone.id, facets_[o].cone.id, true};
        arithmetic_.depth(plane.plane, planes_of(target_).facet, planes.facet);
        halves[count++] = {&plane, 1};
        if constexpr (has_lanes) {
          depth_lanes_ = *lanes;
          depth_lanes_.set(3, plane.plane, 1);
          lanes = &depth_lanes_;
        }
      }
      take_away({&facets_[o], halves.data(), count, lanes});
    }
    if (target_ == none) return left_.each([this](PieceRange left) { this->emit_open(left); });
    const FacetId facet = facets_[target_].cone.id;
    left_.each([this, facet](PieceRange left) { this->emit(facet, left); });
    this->emit_occluders(facet);
  }

  bool split(PieceRange piece, std::size_t begin, std::size_t end, Bounds box, int depth) {
    const std::size_t corner_mark = buffer_.size(), list_mark = list_.size();
    const bool across = box.x1 - box.x0 >= box.y1 - box.y0;
    const double xm = (box.x0 + box.x1) / 2, ym = (box.y0 + box.y1) / 2;
    const auto corner_ray = [&](double x, double y) {
      return this->add_ray(integer_ray(frame_.direction({x, y})));
    };
    const PointId a = across ? corner_ray(xm, box.y0) : corner_ray(box.x0, ym),
                  b = across ? corner_ray(xm, box.y1) : corner_ray(box.x1, ym);
    const auto undo = [&] {
      buffer_.resize(corner_mark);
      list_.resize(list_mark);
      this->drop_rays(a);
      return false;
    };
    if (ray(a) == ray(b)) return undo();
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
    // Splitting does not separate facets that overlap in one place. They are subtracted without a split.
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

  /// Returns whether the positive side of the split plane is the lower half of the box. The result only
  /// assigns boxes to the two parts.
  bool positive_is_low(Half<A> half, bool across, double xm, double ym, const Bounds& box) const {
    const double x = across ? (box.x0 + xm) / 2 : xm, y = across ? ym : (box.y0 + ym) / 2;
    return half.sign * arithmetic_.side(integer_ray(frame_.direction({x, y})), half.plane->plane) > 0;
  }

  /// Returns how `occluder` can hide `target`, from the sides of vertices alone. It hides the target
  /// wherever it covers it, only on the near side of the depth plane, or not at all.
  Hides hides(std::uint32_t target, std::uint32_t occluder) {
    bool near = false, far = false;
    sort_vertices(target, occluder, near, far);
    if (!near && far) return Hides::no;
    if (!near)
      return wins_tie(*mesh_, facets_[occluder].cone.id, facets_[target].cone.id) ? Hides::where_covered
                                                                                  : Hides::no;
    if (!far) return Hides::where_covered;
    bool target_near = false, target_far = false;
    sort_vertices(occluder, target, target_near, target_far);
    if (!target_far) return Hides::no;
    return target_near ? Hides::where_nearer : Hides::where_covered;
  }

  /// Determines whether `facet` has vertices nearer and farther than the plane of `reference`.
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

  static constexpr std::uint32_t none = 0xffffffffu;

  const FacetMesh* mesh_ = nullptr;
  GridPoint apex_;
  CandidateFacets* candidate_facets_ = nullptr;
  VisibilityOptions options_;
  std::uint32_t target_ = none;  ///< current facet; none: the unobstructed region
  std::vector<FramedFacet> facets_;
  std::vector<WallSides> sides_of_walls_;  ///< per facet
  std::vector<std::uint32_t>
      gathered_;                      ///< per facet: its index in the candidate facets (not for hidden ones)
  std::vector<FacetPlanes*> planes_;  ///< per facet; null until they are computed
  ReusedList<FacetPlanes> made_planes_;
  std::vector<Neighbours> neighbours_;
  std::vector<std::uint8_t>
      crowded_;  ///< per facet: whether at least `crowd` other facets share an edge of it
  std::vector<std::pair<double, std::uint32_t>> largest_first_;
  std::vector<std::uint8_t> covered_;    ///< per place in list_
  std::vector<std::uint32_t> covering_;  ///< numbers of facets
  FourHalves depth_lanes_;               ///< of the current occluder with its depth plane
  ReusedList<FourHalves> lanes_;         ///< of occluders
  LayerGrid grid_;
  std::vector<std::uint32_t> candidates_;
  std::vector<Occluder> list_;
  ReusedList<ClipPlane<A>> walls_, depth_planes_;
  std::vector<std::uint8_t>
      where_;  ///< per listed facet: 1 on the positive side of a split, 2 on the negative
};

}  // namespace tubefoot
