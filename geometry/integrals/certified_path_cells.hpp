// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cuts polygons by samples of the path length between two apexes, in ball arithmetic. The result consists of
// certified cells and of gaps whose area is bounded. This header is expensive to compile; include it only in
// .cpp files and in headers of integrators.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/integrals/certified_polygon.hpp"
#include "geometry/integrals/plane_function.hpp"

namespace tubefoot {

/// An apex over a plane: its height, and its foot point in a polygon's coordinates.
struct ApexOverPlane {
  Ball height, x, y;
};
/// `place_m` is relative to the polygon's own apex.
ApexOverPlane apex_over(const CertifiedPolygon& polygon, const std::array<Ball, 3>& place_m);

/// Rays from a centre. Each t selects one ray, with the points centre + X (along + t across) for X > 0. The
/// area element is X dX dt.
template <class N>
struct RayFrameIn {
  N centre_x, centre_y;
  N along_x, along_y;  ///< unit vector; across is `along` after a quarter turn

  using Point = typename PolarPolygon<N, N>::Point;
  N x_of(const Point& p) const { return (p.x - centre_x) * along_x + (p.y - centre_y) * along_y; }
  N y_of(const Point& p) const { return (p.y - centre_y) * along_x - (p.x - centre_x) * along_y; }
  /// `M` is N, or a complex type about it.
  template <class M>
  std::pair<M, M> place(const M& far, const M& t) const {
    const M ax(along_x), ay(along_y);
    return {M(centre_x) + far * (ax - t * ay), M(centre_y) + far * (ay + t * ax)};
  }
};
using RayFrame = RayFrameIn<Ball>;
using IntervalFrame = RayFrameIn<Interval>;
IntervalFrame in_doubles(const RayFrame& frame);

/// Intersection of the rays of a frame with a straight line or with an ellipse of constant path. X is an
/// analytic function of t.
template <class N>
class PathCurveIn {
 public:
  /// The centre itself, with X = 0.
  PathCurveIn() = default;
  /// A line through the point (x, y) of the frame in the direction (dx, dy).
  static PathCurveIn line(const Ball& x, const Ball& y, const Ball& dx, const Ball& dy);
  /// An ellipse that contains the centre.
  static PathCurveIn ellipse(const RayFrame& frame, const ApexOverPlane& tx, const ApexOverPlane& rx,
                             const Ball& path);

  /// `M` is N, or a complex type about it. The result is not finite where the function is not analytic.
  template <class M>
  M at(const M& t) const;
  PathCurveIn<Interval> in_doubles() const;

 private:
  template <class>
  friend class PathCurveIn;
  enum class Kind { centre, line, ellipse };
  Kind kind_ = Kind::centre;
  N k_, dx_, dy_;             // for an ellipse, k is the coefficient c
  N a0_, a1_, a2_, b0_, b1_;  // coefficients of an ellipse
};
using PathCurve = PathCurveIn<Ball>;
using IntervalCurve = PathCurveIn<Interval>;

/// Cuts convex polygons into cells and gaps. A cell { t between two numbers, X between two curves } belongs
/// to one sample. A gap is the rest that a sample may contain; only a bound of its area is known.
///
/// PathCutter uses the same method in doubles. Points of one path length lie on an ellipse about the plane's
/// point of shortest path. The curves that bound a ray change at corners and where edges cross ellipses.
/// Each cell lies strictly between the enclosures of all such t, so that its bounding curves are certain.
/// These enclosures and those of the polygon's corners are the gaps, some 1e-15 of the polygon.
///
/// With a second receiver a sample contains the points that lie in it for both paths. An ellipse that does
/// not certainly contain the centre is omitted, and the disk that contains the ellipse is a gap.
class CertifiedPathCutter {
 public:
  struct Cell {
    std::uint32_t frame = 0, sample = 0;
    PathCurve near, far;
    Ball from, to;  ///< interval of t
  };
  struct Gap {
    std::uint32_t first_sample = 0, end_sample = 0;
    Ball area;  ///< upper bound
  };

  /// Sample k contains half paths from borders[k] to borders[k + 1].
  explicit CertifiedPathCutter(std::span<const double> half_path_borders_m);

  /// Cuts a polygon for one or two receivers (`homes`). The new cells and gaps replace those of the previous
  /// polygon. With `ambiguous` the result is a single gap of that area, somewhere in the polygon.
  void cut(const CertifiedPolygon& polygon, const ApexOverPlane& tx, std::span<const ApexOverPlane> homes,
           const std::optional<Ball>& ambiguous = {});
  const std::vector<RayFrame>& frames() const { return frames_; }
  /// True if the centre of the rays may lie in the polygon or on an edge. Gaps may then reach the centre.
  bool about_centre() const { return about_centre_; }
  CertifiedPolygon::Point centre() const { return {centre_x_, centre_y_}; }
  const std::vector<Cell>& cells() const { return cells_; }
  const std::vector<Gap>& gaps() const { return gaps_; }

 private:
  /// A point or an edge in a frame.
  struct At {
    Ball x, y;
  };
  struct Edge {
    At from, to;
    Ball t_from, t_to;
    int side;  ///< 1: the polygon is between the edge and the centre; -1: beyond the edge; 0: undecided
  };
  /// An enclosure of t within which nothing is decided.
  struct Stretch {
    long double lo, hi;
  };
  /// State of a border's ellipse for one receiver.
  enum class Ring { nothing, ambiguous, holds_centre };
  struct ReceiveEnd {
    ApexOverPlane apex;
    Ball path_at_centre, shortest;
    std::vector<Ring> ring;  ///< by border, from first_
  };

  void find_rings(const CertifiedPolygon& polygon);
  void cut_sectors(std::uint32_t frame, const std::vector<Edge>& edges, bool from_centre);
  void cut_sample(std::uint32_t frame, std::size_t sample, const Edge* near, const Edge& far,
                  const Stretch& sector);
  void give_gap(std::size_t first, std::size_t end, const Ball& area);
  Ball area_of(long double lo, long double hi) const;
  Ball path_to(const ApexOverPlane& rx, const Ball& x, const Ball& y) const;
  double least_path(const RayFrame& frame, const Edge& edge) const;
  void add_crossings(const RayFrame& frame, const Edge& edge, const ReceiveEnd& rx, std::size_t border,
                     std::vector<Stretch>& at) const;
  void add_meetings(const RayFrame& frame, std::size_t first_border, std::size_t second_border,
                    std::vector<Stretch>& at) const;
  void add_roots(const RayFrame& frame, const ApexOverPlane& rx, const Ball& path, const At& from,
                 const At& way, bool within, std::vector<Stretch>& at) const;

  std::span<const double> borders_;
  std::vector<RayFrame> frames_;
  std::vector<Cell> cells_;
  std::vector<Gap> gaps_;
  // State of the current polygon.
  ApexOverPlane tx_;
  Ball centre_x_, centre_y_;
  bool about_centre_ = false;
  std::vector<ReceiveEnd> homes_;
  std::size_t first_ = 0, end_ = 0;  // samples that the polygon may reach
  Ball reach2_;                      // bound of area / dt: difference of the squares of farthest and nearest
                                     // X
  std::vector<Stretch> at_, merged_;
};

}  // namespace tubefoot
