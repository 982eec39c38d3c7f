// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "geometry/visibility/piece_cutter.hpp"
#include "geometry/visibility/visibility.hpp"
#include "geometry/visibility/visibility_state.hpp"

// Divides the visible pieces of a pyramid among the tubes inside it, and writes them with their names. The
// walls of the tubes cut the pieces with exact signs, so the regions are those of each tube alone.

namespace tubefoot {

/// Writes pieces to the results of the tubes of a run. A single tube is its own pyramid, and its pieces are
/// written as they are.
template <class A>
class PieceDivider : protected PieceCutter<A> {
 protected:
  using Base = PieceCutter<A>;
  using Base::arithmetic_, Base::buffer_, Base::removed_, Base::has_lanes, Base::clip_to;
  using typename Base::FourHalves;

  /// Sides of four walls on which a facet's vertices lie: bit 3 w + k for vertex k strictly inside, or
  /// outside, wall w.
  struct WallSides {
    std::uint16_t inside = 0, outside = 0;
    /// Returns one bit for each wall with a vertex outside it.
    unsigned cutting() const {
      unsigned walls = 0;
      for (unsigned w = 0; w < 4; ++w)
        if (outside >> 3 * w & 7u) walls |= 1u << w;
      return walls;
    }
  };

  /// The four walls of a tube or of the pyramid.
  struct Walls {
    std::array<ClipPlane<A>, 4> planes;
    std::array<Half<A>, 4> halves;
    FourHalves lanes;
  };

  /// A tube that a facet may enter, and one bit for each of its walls that may cut the facet.
  struct Entered {
    std::uint32_t tube;
    unsigned cutting;
  };

  static constexpr unsigned all_walls = 0b1111;

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

  GridPoint ray(PointId id) const { return rays_[id & ~ray_bit]; }
  PointId add_ray(GridPoint direction) {
    rays_.push_back(direction);
    return ray_bit | static_cast<PointId>(rays_.size() - 1);
  }

  /// Removes the rays from `id` on.
  void drop_rays(PointId id) { rays_.resize(id & ~ray_bit); }

  /// Starts the tubes of a run. The results of earlier runs are overwritten.
  void begin_tubes(const TubesInPyramid& tubes, std::span<TubeVisibility> out) {
    out_ = out;
    rays_.assign(tubes.tubes.front().begin(), tubes.tubes.front().end());
    first_ray_ = 0;
    if (!is_single()) {
      first_ray_ = 4;
      rays_.insert(rays_.end(), tubes.pyramid.begin(), tubes.pyramid.end());
    }
    make_walls(first_ray_, tubes.pyramid, pyramid_);
    frame_ = GnomonicFrame(tubes.pyramid);
    if (parts_.size() < out.size()) parts_.resize(out.size());
    for (std::size_t t = 0; t < out.size(); ++t) {
      const std::array<GridPoint, 4>& rays = tubes.tubes[t];
      out[t].clear();
      out[t].rays.assign(rays.begin(), rays.end());
      if (is_single()) break;
      Part& part = parts_[t];
      make_walls(0, rays, part.walls);
      part.split_rays.clear();
      part.bounds = Bounds::nothing();
      for (const GridPoint& d : rays) {
        glm::dvec2 p;
        if (!frame_.project(as_double(d), glm::length(as_double(d)), p)) {
          part.bounds = Bounds::everything();
          break;
        }
        part.bounds.add(p);
      }
      part.bounds.widen(1e-9);  // far more than the errors of coordinates, which are below 2
    }
    entered_.assign(1, {0, 0});
  }

  /// Completes the results.
  void end_tubes() {
    if (is_single()) out_[0].rays = rays_;
  }

  bool is_single() const { return out_.size() == 1; }

  /// Returns false if the facet has no vertex strictly inside some of the walls. Exact.
  bool enters(const FacetCone& cone, const Walls& walls, WallSides& sides) const {
    [[maybe_unused]] std::array<unsigned, 3> at_a_glance{};
    if constexpr (has_lanes)
      for (unsigned k = 0; k < 3; ++k) at_a_glance[k] = arithmetic_.double_sides(cone.point[k], walls.lanes);
    for (unsigned w = 0; w < 4; ++w) {
      const Half<A> half = walls.halves[w];
      unsigned inside = 0, outside = 0;
      for (unsigned k = 0; k < 3; ++k) {
        if (const unsigned seen = at_a_glance[k] >> w & 0x11u) {
          inside |= (seen & 1u) << k;
          outside |= (seen >> 4) << k;
          continue;
        }
        const int s = half.sign * arithmetic_.side(cone.point[k], half.plane->plane);
        inside |= static_cast<unsigned>(s > 0) << k;
        outside |= static_cast<unsigned>(s < 0) << k;
      }
      if (inside == 0) return false;
      sides.inside = static_cast<std::uint16_t>(sides.inside | inside << 3 * w);
      sides.outside = static_cast<std::uint16_t>(sides.outside | outside << 3 * w);
    }
    return true;
  }

  /// Finds the tubes to which the following pieces of this facet are written. Returns whether there are any.
  bool find_tubes(const FramedFacet& facet) {
    if (is_single()) return true;
    entered_.clear();
    for (std::uint32_t t = 0; t < out_.size(); ++t) {
      if (!facet.bounds.meets(parts_[t].bounds)) continue;
      if (WallSides sides; enters(facet.cone, parts_[t].walls, sides))
        entered_.push_back({t, sides.cutting()});
    }
    return !entered_.empty();
  }

  /// Selects all tubes for the following pieces.
  void take_all_tubes() {
    entered_.clear();
    for (std::uint32_t t = 0; t < out_.size(); ++t) entered_.push_back({t, is_single() ? 0 : all_walls});
  }

  /// Whether no wall of a tube cuts the facet.
  bool is_whole_in_tubes() const {
    return std::ranges::all_of(entered_, [](const Entered& e) { return e.cutting == 0; });
  }

  /// Calls use(result, part) for the part of a piece in each of the tubes found.
  template <class Use>
  void divide(PieceRange piece, const Use& use) {
    for (const auto& [tube, cutting] : entered_) {
      const std::size_t mark = buffer_.size();
      PieceRange part = piece;
      bool remains = true;
      for (unsigned w = 0; w < 4 && remains; ++w)
        if (cutting >> w & 1u) remains = clip_to(part, parts_[tube].walls.halves[w]);
      if (remains) use(tube, part);
      buffer_.resize(mark);
    }
  }

  /// Writes a visible piece of a facet to the tubes found.
  void emit(FacetId facet, PieceRange piece) {
    divide(piece, [&](std::uint32_t tube, PieceRange part) { write(tube, out_[tube].pieces, facet, part); });
  }

  /// Writes an unobstructed piece to the tubes found.
  void emit_open(PieceRange piece) {
    divide(piece, [&](std::uint32_t tube, PieceRange part) { write(tube, out_[tube].open, no_point, part); });
  }

  /// Writes a facet that is visible as a whole to the tubes found.
  void emit_whole(const FacetCone& cone) {
    for (const Entered& entered : entered_) {
      TubeVisibility& out = out_[entered.tube];
      out.pieces.push_back({cone.id, static_cast<std::uint32_t>(out.corners.size()), 3});
      for (const VertexId vertex : cone.vertex) out.corners.emplace_back().point = vertex;
    }
  }

  /// Writes to each of the tubes found which facets hide a part of `facet`: those of removed_.
  void emit_occluders(FacetId facet) {
    for (const auto& [occluder, piece] : removed_)
      divide(piece, [&, pair = std::pair(facet, occluder)](std::uint32_t tube, PieceRange) {
        if (auto& pairs = out_[tube].occluders; pairs.empty() || pairs.back() != pair) pairs.push_back(pair);
      });
  }

  /// Sorts the facets that hide a part of `facet`, after its last piece.
  void sort_occluders(FacetId facet) {
    for (const Entered& entered : entered_) {
      auto& pairs = out_[entered.tube].occluders;
      auto begin = pairs.end();
      while (begin != pairs.begin() && std::prev(begin)->first == facet) --begin;
      std::sort(begin, pairs.end());
      pairs.erase(std::unique(begin, pairs.end()), pairs.end());
    }
  }

  Walls pyramid_;
  PointId first_ray_ = 0;  ///< number of the pyramid's first ray
  GnomonicFrame frame_;    ///< of the pyramid

 private:
  /// A tube of a run.
  struct Part {
    Walls walls;
    Bounds bounds;
    std::vector<PointId> split_rays;  ///< rays of planes that split the pyramid, in the order of the result
  };

  void make_walls(PointId first, const std::array<GridPoint, 4>& rays, Walls& walls) const {
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t next = (k + 1) % 4;
      walls.planes[k] = plane_through(ray_bit | (first + k), rays[k], ray_bit | (first + next), rays[next]);
      walls.halves[k] = {&walls.planes[k], k < next ? 1 : -1};
      if constexpr (has_lanes) walls.lanes.set(k, walls.planes[k].plane, walls.halves[k].sign);
    }
  }

  void write(std::uint32_t tube, std::vector<NamedPiece>& pieces, FacetId facet, PieceRange piece) {
    TubeVisibility& out = out_[tube];
    const auto first = static_cast<std::uint32_t>(out.corners.size());
    pieces.push_back({facet, first, piece.count});
    out.corners.resize(first + piece.count);
    for (std::uint32_t k = 0; k < piece.count; ++k) {
      const ClipCorner<A>& c = buffer_[piece.first + k];
      CornerName& name = out.corners[first + k];
      name.point = c.point;
      if (c.point == no_point) {
        name.p = c.p.plane->name;
        name.q = c.q.plane->name;
        name.sign = c.p.sign * c.q.sign;
      }
      if (rays_.size() > first_ray_ + 4 && first_ray_ > 0) renumber(tube, name);
    }
  }

  /// Replaces the numbers of rays of splits by those in the result of a tube, which it gives as they occur.
  void renumber(std::uint32_t tube, CornerName& name) {
    const auto replace = [&](PointId& id) {
      if (id == no_point || !(id & ray_bit) || id < (ray_bit | first_ray_)) return;
      std::vector<PointId>& known = parts_[tube].split_rays;
      auto found = std::find(known.rbegin(), known.rend(), id);
      if (found == known.rend()) {
        known.push_back(id);
        out_[tube].rays.push_back(ray(id));
        found = known.rbegin();
      }
      id = ray_bit | static_cast<PointId>(4 + (known.rend() - found) - 1);
    };
    replace(name.point);
    if (name.point != no_point) return;
    for (PlaneName* plane : {&name.p, &name.q}) {
      if (plane->depth) continue;
      replace(plane->a);
      replace(plane->b);
      if (plane->a < plane->b) continue;
      // The order of its points defines the plane's normal.
      std::swap(plane->a, plane->b);
      name.sign = -name.sign;
    }
  }

  std::span<TubeVisibility> out_;  ///< one result per tube
  /// Those of the names. For a single tube: its rays and those of splits. For a run: four that stand for
  /// those of the current tube, those of the pyramid, and those of splits.
  std::vector<GridPoint> rays_;
  std::vector<Part> parts_;  ///< of the first tubes; unused parts keep their memory
  std::vector<Entered> entered_;
};

}  // namespace tubefoot
