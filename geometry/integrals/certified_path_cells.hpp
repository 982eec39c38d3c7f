// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/integrals/certified_polygon.hpp"
#include "geometry/numbers/interval.hpp"

// A polygon cut by samples of path length, two apexes, in balls. Heavy: include only in .cpp files and
// headers of integrators.
namespace tubefoot {

/// An apex over a plane: its height, and its foot point in a polygon's coordinates.
struct ApexOverPlane {
  Ball height, x, y;
};
/// `place_m`: relative to the polygon's own apex.
ApexOverPlane apex_over(const CertifiedPolygon& polygon, const std::array<Ball, 3>& place_m);

/// Rounded outwards to doubles.
inline Interval interval_of(const Ball& x) { return {x.lo(), x.hi()}; }

/// Rays from a centre: one for each t, its places centre + X (along + t across) for X > 0; an area is X dX
/// dt.
struct RayFrame {
  Ball centre_x, centre_y;
  Ball along_x, along_y;  ///< unit; across is a quarter turn further

  Ball x_of(const CertifiedPolygon::Point& p) const {
    return (p.x - centre_x) * along_x + (p.y - centre_y) * along_y;
  }
  Ball y_of(const CertifiedPolygon::Point& p) const {
    return (p.y - centre_y) * along_x - (p.x - centre_x) * along_y;
  }
  template <class N>
  std::pair<N, N> place(const N& far, const N& t) const {
    const N ax(along_x), ay(along_y);
    return {N(centre_x) + far * (ax - t * ay), N(centre_y) + far * (ay + t * ax)};
  }
};
/// The same frame in intervals of doubles.
struct IntervalFrame {
  Interval centre_x, centre_y, along_x, along_y;

  IntervalFrame() = default;
  explicit IntervalFrame(const RayFrame& frame)
      : centre_x(interval_of(frame.centre_x)),
        centre_y(interval_of(frame.centre_y)),
        along_x(interval_of(frame.along_x)),
        along_y(interval_of(frame.along_y)) {}
  std::pair<Interval, Interval> place(const Interval& far, const Interval& t) const {
    return {centre_x + far * (along_x - t * along_y), centre_y + far * (along_y + t * along_x)};
  }
};

/// Where rays of a frame meet a straight line or an ellipse (a place's path to two apexes): X as an analytic
/// function of t.
class PathCurve {
 public:
  /// The centre itself.
  PathCurve() = default;
  /// Through a place of the frame, in a direction.
  static PathCurve line(const Ball& x, const Ball& y, const Ball& dx, const Ball& dy);
  /// About a centre that is inside of it.
  static PathCurve ellipse(const RayFrame& frame, const ApexOverPlane& tx, const ApexOverPlane& rx,
                           const Ball& path);

  Ball at(const Ball& t) const;
  /// Not finite where it is not analytic.
  ComplexBall at(const ComplexBall& t) const;

 private:
  friend class IntervalCurve;
  enum class Kind { centre, line, ellipse };
  Kind kind_ = Kind::centre;
  Ball k_, dx_, dy_;             // k: of an ellipse, c
  Ball a0_, a1_, a2_, b0_, b1_;  // of an ellipse
};

/// The same curve in intervals of doubles.
class IntervalCurve {
 public:
  IntervalCurve() = default;
  explicit IntervalCurve(const PathCurve& curve);
  Interval at(const Interval& t) const;

 private:
  PathCurve::Kind kind_ = PathCurve::Kind::centre;
  Interval k_, dx_, dy_, a0_, a1_, a2_, b0_, b1_;
};

/// Cuts convex polygons into cells { t between two numbers, X between two curves } of one sample each, and
/// gaps: what a sample may have besides, of which only the area is known.
///
/// As PathCutter does it in doubles: places of one path length are an ellipse about the plane's place of
/// shortest path. Cells lie strictly between the enclosures of all t at which what bounds a ray changes
/// (corners, and where edges cross ellipses), so what bounds them is certain; the enclosures are the gaps,
/// some 1e-15 of the polygon, as its corners' are.
///
/// With a second receiver a sample is what both paths have in it. An ellipse that does not surely hold the
/// centre is left out, and the disk that holds it is a gap.
class CertifiedPathCutter {
 public:
  struct Cell {
    std::uint32_t frame = 0, sample = 0;
    PathCurve near, far;
    Ball from, to;  ///< of t
  };
  struct Gap {
    std::uint32_t first_sample = 0, end_sample = 0;
    Ball area;  ///< at most
  };

  /// Sample k holds half paths of borders[k] .. borders[k + 1].
  explicit CertifiedPathCutter(std::span<const double> half_path_borders_m);

  /// One home or two. Cells and gaps replace those of the polygon before. With `ambiguous` there is only a
  /// gap of that area, somewhere in the polygon.
  void cut(const CertifiedPolygon& polygon, const ApexOverPlane& tx, std::span<const ApexOverPlane> homes,
           const std::optional<Ball>& ambiguous = {});
  const std::vector<RayFrame>& frames() const { return frames_; }
  /// Whether the rays' centre may lie in the polygon, or on an edge: then gaps may reach there.
  bool about_centre() const { return about_centre_; }
  CertifiedPolygon::Point centre() const { return {centre_x_, centre_y_}; }
  const std::vector<Cell>& cells() const { return cells_; }
  const std::vector<Gap>& gaps() const { return gaps_; }

 private:
  /// A place or an edge in a frame.
  struct At {
    Ball x, y;
  };
  struct Edge {
    At from, to;
    Ball t_from, t_to;
    int side;  ///< 1: what lies between it and the centre is inside; -1: beyond it; 0: not known
  };
  /// Enclosures of t that nothing is sure in.
  struct Stretch {
    long double lo, hi;
  };
  /// What of a border there is for a home.
  enum class Ring { nothing, ambiguous, holds_centre };
  struct ReceiveEnd {
    ApexOverPlane apex;
    Ball path_at_centre, shortest;
    std::vector<Ring> ring;  ///< by border from first_
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
  // Of the polygon at hand.
  ApexOverPlane tx_;
  Ball centre_x_, centre_y_;
  bool about_centre_ = false;
  std::vector<ReceiveEnd> homes_;
  std::size_t first_ = 0, end_ = 0;  // samples that it may reach
  Ball reach2_;                      // of an area over dt: between its nearest and its farthest X, squared
  std::vector<Stretch> at_, merged_;
};

}  // namespace tubefoot
