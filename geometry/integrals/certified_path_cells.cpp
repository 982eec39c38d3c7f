// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts certified convex polygons by samples of path length: cells between two curves, and gaps of known
// area. Each ellipse of constant path is the root of a quadratic equation in the frame of a ray. Ball
// arithmetic decides every comparison; an undecided part becomes a gap. certified_path_cells.hpp describes
// cells and gaps.

#include "geometry/integrals/certified_path_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/numbers/ball_vector.hpp"
#include "geometry/numbers/complex_ranges.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

constexpr long double endless = std::numeric_limits<long double>::infinity();

Ball size2(const Ball& x, const Ball& y) { return squared(x) + squared(y); }

/// The narrowest enclosure of x / y for each number type, and that of the root.
Ball quotient(const Ball& x, const Ball& y) { return x / y; }
Interval quotient(const Interval& x, const Interval& y) { return x / y; }
ComplexBall quotient(const ComplexBall& x, const ComplexBall& y) { return x * tight_inverse(y); }
Ball narrow_root(const Ball& x) { return root(x); }
Interval narrow_root(const Interval& x) { return root(x); }
ComplexBall narrow_root(const ComplexBall& x) { return tight_root(x); }
double middle_of(const Ball& x) { return x.middle(); }
double middle_of(const Interval& x) { return x.middle(); }
double middle_of(const ComplexBall& x) { return x.real().middle(); }

/// Sorts the stretches and joins those that overlap, so that they are disjoint.
template <class Stretch>
void merge(std::vector<Stretch>& at) {
  std::sort(at.begin(), at.end(), [](const Stretch& a, const Stretch& b) { return a.lo < b.lo; });
  std::size_t kept = 0;
  for (std::size_t k = 1; k < at.size(); ++k) {
    if (at[k].lo <= at[kept].hi)
      at[kept].hi = std::max(at[kept].hi, at[k].hi);
    else
      at[++kept] = at[k];
  }
  if (!at.empty()) at.resize(kept + 1);
}

}  // namespace

ApexOverPlane apex_over(const CertifiedPolygon& polygon, const std::array<Ball, 3>& place_m) {
  const auto along = [&](const std::array<Ball, 3>& e) {
    return e[0] * place_m[0] + e[1] * place_m[1] + e[2] * place_m[2];
  };
  return {polygon.distance - along(polygon.away), along(polygon.u), along(polygon.v)};
}

template <>
PathCurve PathCurve::line(const Ball& x, const Ball& y, const Ball& dx, const Ball& dy) {
  PathCurve curve;
  curve.kind_ = Kind::line;
  curve.k_ = cross(x, y, dx, dy);
  curve.dx_ = dx;
  curve.dy_ = dy;
  return curve;
}

/// Let the squared range to the transmitter along (1, t) be r_tx^2 = A + 2 B X + D X^2 with D = 1 + t^2, and
/// let r_rx^2 have the same form. Then
///   4 P^2 r_tx^2 = (P^2 + r_tx^2 - r_rx^2)^2
/// is a quadratic equation in X.
template <>
PathCurve PathCurve::ellipse(const RayFrame& frame, const ApexOverPlane& tx, const ApexOverPlane& rx,
                             const Ball& path) {
  const Ball ox = frame.x_of({tx.x, tx.y}), oy = frame.y_of({tx.x, tx.y}), hx = frame.x_of({rx.x, rx.y}),
             hy = frame.y_of({rx.x, rx.y});
  const Ball out2 = squared(tx.height) + size2(ox, oy), home2 = squared(rx.height) + size2(hx, hy);
  const Ball ro = root(out2), rh = root(home2), path2 = squared(path), four(4), two(2);
  const Ball m0 = hx - ox, m1 = hy - oy, sum = two * (path2 + out2 - home2);
  PathCurve curve;
  curve.kind_ = Kind::ellipse;
  curve.a0_ = four * (path2 - squared(m0));
  curve.a1_ = -(Ball(8) * m0 * m1);
  curve.a2_ = four * (path2 - squared(m1));
  curve.b0_ = -(four * path2 * ox) - m0 * sum;
  curve.b1_ = -(four * path2 * oy) - m1 * sum;
  curve.k_ = -((path - ro - rh) * (path - ro + rh) * (path + ro - rh) * (path + ro + rh));
  return curve;
}

/// Solves a X^2 + 2 b X + c = 0 with c < 0. The sign of b selects the form of the root in which nothing
/// cancels.
template <class N>
template <class M>
M PathCurveIn<N>::at(const M& t) const {
  if (kind_ == Kind::centre) return {};
  if (kind_ == Kind::line) return quotient(M(k_), M(dy_) - t * M(dx_));
  const M a = M(a0_) + t * (M(a1_) + t * M(a2_)), b = M(b0_) + t * M(b1_),
          far = narrow_root(squared(b) - a * M(k_));
  return middle_of(b) > 0 ? quotient(-M(k_), b + far) : quotient(far - b, a);
}
template Ball PathCurve::at(const Ball&) const;
template ComplexBall PathCurve::at(const ComplexBall&) const;
template Interval IntervalCurve::at(const Interval&) const;

template <>
IntervalCurve PathCurve::in_doubles() const {
  IntervalCurve curve;
  curve.kind_ = IntervalCurve::Kind(kind_);
  curve.k_ = interval_of(k_);
  curve.dx_ = interval_of(dx_);
  curve.dy_ = interval_of(dy_);
  curve.a0_ = interval_of(a0_);
  curve.a1_ = interval_of(a1_);
  curve.a2_ = interval_of(a2_);
  curve.b0_ = interval_of(b0_);
  curve.b1_ = interval_of(b1_);
  return curve;
}

IntervalFrame in_doubles(const RayFrame& frame) {
  return {interval_of(frame.centre_x), interval_of(frame.centre_y), interval_of(frame.along_x),
          interval_of(frame.along_y)};
}

CertifiedPathCutter::CertifiedPathCutter(std::span<const double> half_path_borders_m)
    : borders_(half_path_borders_m) {}

Ball CertifiedPathCutter::path_to(const ApexOverPlane& rx, const Ball& x, const Ball& y) const {
  return root(squared(tx_.height) + size2(x - tx_.x, y - tx_.y)) +
         root(squared(rx.height) + size2(x - rx.x, y - rx.y));
}

void CertifiedPathCutter::give_gap(std::size_t first, std::size_t end, const Ball& area) {
  if (first < end) gaps_.push_back({std::uint32_t(first), std::uint32_t(end), Ball(area.hi())});
}

Ball CertifiedPathCutter::area_of(long double lo, long double hi) const {
  return (Ball(hi) - Ball(lo)) * reach2_ / Ball(2);
}

/// Lower bound of the path over an edge.
double CertifiedPathCutter::least_path(const RayFrame& frame, const Edge& edge) const {
  const Ball dx = edge.to.x - edge.from.x, dy = edge.to.y - edge.from.y, length2 = size2(dx, dy);
  const auto least = [&](const ApexOverPlane& apex) {
    const Ball x = edge.from.x - frame.x_of({apex.x, apex.y}), y = edge.from.y - frame.y_of({apex.x, apex.y});
    const Ball along = dot(x, y, dx, dy);
    Ball aside2;
    if (along.surely_positive())
      aside2 = size2(x, y);
    else if ((along + length2).surely_negative())
      aside2 = size2(x + dx, y + dy);
    else if (length2.surely_positive())
      aside2 = squared(cross(x, y, dx, dy)) / length2;
    return root(squared(apex.height) + Ball(std::max(aside2.lo(), 0.0)));
  };
  return std::max((least(tx_) + least(homes_[0].apex)).lo(), homes_[0].shortest.lo());
}

void CertifiedPathCutter::cut(const CertifiedPolygon& polygon, const ApexOverPlane& tx,
                              std::span<const ApexOverPlane> homes, const std::optional<Ball>& ambiguous) {
  frames_.clear();
  cells_.clear();
  gaps_.clear();
  const std::size_t n = polygon.points.size();
  if (n < 3 || borders_.size() < 2) return;
  tx_ = tx;
  // The centre is the point where the straight line from the transmitter to the mirrored receiver meets the
  // plane.
  const Ball share = tx.height / (tx.height + homes[0].height);
  centre_x_ = (tx.x + (homes[0].x - tx.x) * share).centre();
  centre_y_ = (tx.y + (homes[0].y - tx.y) * share).centre();
  homes_.clear();
  for (const ApexOverPlane& rx : homes) {
    const Ball heights = tx.height + rx.height;
    homes_.push_back({rx,
                      path_to(rx, centre_x_, centre_y_),
                      root(squared(heights) + size2(rx.x - tx.x, rx.y - tx.y)),
                      {}});
  }

  double longest = 0;
  std::vector<At> at;
  for (const CertifiedPolygon::Point& p : polygon.points) {
    longest = std::max(longest, path_to(homes[0], p.x, p.y).hi());
    at.push_back({p.x - centre_x_, p.y - centre_y_});
  }
  const auto next = [&](std::size_t i) { return i + 1 == n ? 0 : i + 1; };
  std::vector<int> side(n);
  std::size_t lowest = n;
  double most_below = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const At &a = at[i], &b = at[next(i)];
    const Ball product = cross(a.x, a.y, b.x, b.y);
    side[i] = sign(product);
    const double below = -product.middle() / std::sqrt(size2(b.x - a.x, b.y - a.y).middle());
    if (side[i] < 0 && (lowest == n || below > most_below)) {
      lowest = i;
      most_below = below;
    }
  }
  const auto normal_frame = [&](std::size_t i, int turn) {
    const Ball dx = at[next(i)].x - at[i].x, dy = at[next(i)].y - at[i].y,
               per = Ball(turn) / root(size2(dx, dy));
    return RayFrame{centre_x_, centre_y_, dy * per, -(dx * per)};
  };
  const auto edge_in = [&](const RayFrame& frame, std::size_t i) {
    const CertifiedPolygon::Point &p = polygon.points[i], &q = polygon.points[next(i)];
    Edge edge{{frame.x_of(p), frame.y_of(p)}, {frame.x_of(q), frame.y_of(q)}, {}, {}, side[i]};
    edge.t_from = edge.from.y / edge.from.x;
    edge.t_to = edge.to.y / edge.to.x;
    return edge;
  };
  const auto samples_from = [&](double least) {
    const auto first = std::upper_bound(borders_.begin(), borders_.end(), least / 2 * (1 - 1e-15));
    const auto last = std::lower_bound(borders_.begin(), borders_.end(), longest / 2 * (1 + 1e-15));
    const auto samples = std::ptrdiff_t(borders_.size()) - 1;
    first_ = std::size_t(std::clamp<std::ptrdiff_t>(first - borders_.begin() - 1, 0, samples));
    end_ = std::size_t(std::clamp<std::ptrdiff_t>(last - borders_.begin(), std::ptrdiff_t(first_), samples));
  };

  about_centre_ = lowest == n;
  if (!about_centre_) {
    // The centre is certainly beyond this edge. The whole polygon lies on the inner side of the edge.
    const RayFrame frame = normal_frame(lowest, -1);
    frames_.push_back(frame);
    std::vector<Edge> edges;
    double least = std::numeric_limits<double>::infinity();
    Ball nearest, farthest;
    bool before = true;
    for (std::size_t i = 0; i < n; ++i) {
      edges.push_back(edge_in(frame, i));
      const Ball& x = edges.back().from.x;
      before = before && x.surely_positive();
      nearest = i == 0 || x.lo() < nearest.lo() ? x : nearest;
      farthest = i == 0 || x.hi() > farthest.hi() ? x : farthest;
      least = std::min(least, least_path(frame, edges.back()));
    }
    samples_from(least);
    if (ambiguous) give_gap(first_, end_, *ambiguous);
    if (first_ >= end_ || ambiguous) return;
    find_rings(polygon);
    const Ball from(std::max(nearest.lo(), 0.0)), to(farthest.hi());
    reach2_ = squared(to) - squared(from);
    if (before) return cut_sectors(0, edges, false);
    // The plane through the centre is edge-on at this precision. The polygon is as thin as the product of
    // both extents.
    Ball wide, high;
    for (const Edge& edge : edges) {
      wide = hull(wide, edge.from.x - edges[0].from.x);
      high = hull(high, edge.from.y - edges[0].from.y);
    }
    return give_gap(first_, end_, (Ball(wide.hi()) - Ball(wide.lo())) * (Ball(high.hi()) - Ball(high.lo())));
  }
  samples_from(homes_[0].shortest.lo());
  if (ambiguous) give_gap(first_, end_, *ambiguous);
  if (first_ >= end_ || ambiguous) return;
  find_rings(polygon);
  for (std::size_t i = 0; i < n; ++i) {
    stop_if_wanted();
    if (side[i] == 0) {
      // The line of this edge passes through the centre at this precision. The triangle between them has
      // this area at most.
      const Ball product = cross(at[i].x, at[i].y, at[next(i)].x, at[next(i)].y) / Ball(2);
      give_gap(first_, end_, Ball(std::max(product.hi(), -product.lo())));
      continue;
    }
    frames_.push_back(normal_frame(i, 1));
    const Edge edge = edge_in(frames_.back(), i);
    reach2_ = squared(Ball(std::max(edge.from.x.hi(), edge.to.x.hi())));
    cut_sectors(std::uint32_t(frames_.size() - 1), {edge}, true);
  }
}

/// Omits each border whose ellipse does not certainly contain the centre. The samples on both sides of that
/// border then differ by no more than the disk that contains the ellipse.
void CertifiedPathCutter::find_rings(const CertifiedPolygon& polygon) {
  Ball size;  // hull of the squared distances from the first point
  for (const CertifiedPolygon::Point& p : polygon.points)
    size = hull(size, size2(p.x - polygon.points[0].x, p.y - polygon.points[0].y));
  for (ReceiveEnd& rx : homes_) {
    const Ball share = tx_.height / (tx_.height + rx.apex.height);
    const Ball own_x = tx_.x + (rx.apex.x - tx_.x) * share, own_y = tx_.y + (rx.apex.y - tx_.y) * share;
    for (std::size_t border = first_; border <= end_; ++border) {
      const Ball path = Ball(2) * Ball(borders_[border]);
      Ring ring = Ring::ambiguous;
      if ((path - rx.path_at_centre).surely_positive())
        ring = Ring::holds_centre;
      else if ((path - rx.shortest).surely_negative())
        ring = Ring::nothing;
      rx.ring.push_back(ring);
      if (ring != Ring::ambiguous) continue;
      // The distance of a point from the line between the apexes' images is at most half of sqrt(P^2 - l^2).
      const Ball beyond(std::max((squared(path) - squared(rx.shortest)).hi(), 0.0));
      const Ball radius = rx.shortest * root(beyond) / (Ball(2) * (tx_.height + rx.apex.height)) +
                          root(size2(own_x - centre_x_, own_y - centre_y_));
      const Ball disk = Ball(4) * squared(Ball(radius.hi()));
      const Ball whole = Ball::pi() * Ball(size.hi());
      give_gap(std::max(border, first_ + 1) - 1, std::min(border + 1, end_),
               disk.hi() < whole.hi() ? disk : whole);
    }
  }
}

void CertifiedPathCutter::cut_sectors(std::uint32_t number, const std::vector<Edge>& edges,
                                      bool from_centre) {
  const RayFrame& frame = frames_[number];
  std::vector<Stretch> corners;
  for (const Edge& edge : edges) {
    corners.push_back({edge.t_from.fine_lo(), edge.t_from.fine_hi()});
    if (from_centre) corners.push_back({edge.t_to.fine_lo(), edge.t_to.fine_hi()});
    if (edge.side != 0) continue;
    const Ball all = hull(edge.t_from, edge.t_to);  // This edge runs along a ray at this precision.
    corners.push_back({all.fine_lo(), all.fine_hi()});
  }
  merge(corners);
  for (const Stretch& corner : corners) give_gap(first_, end_, area_of(corner.lo, corner.hi));
  for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
    stop_if_wanted();
    const Stretch sector{corners[k].hi, corners[k + 1].lo};
    const Edge *far = nullptr, *near = nullptr;
    int fars = 0, nears = 0;
    for (const Edge& edge : edges) {
      const Ball &begin = edge.side > 0 ? edge.t_from : edge.t_to,
                 &end = edge.side > 0 ? edge.t_to : edge.t_from;
      if (edge.side == 0 || begin.fine_hi() > sector.lo || end.fine_lo() < sector.hi) continue;
      (edge.side > 0 ? far : near) = &edge;
      ++(edge.side > 0 ? fars : nears);
    }
    if (fars != 1 || nears != (from_centre ? 0 : 1)) {
      give_gap(first_, end_, area_of(sector.lo, sector.hi));
      continue;
    }
    const auto path_at = [&](const Edge& edge, long double t) {
      const Ball at(t),
          x = PathCurve::line(edge.from.x, edge.from.y, edge.to.x - edge.from.x, edge.to.y - edge.from.y)
                  .at(at);
      const auto [px, py] = frame.place(x, at);
      return path_to(homes_[0].apex, px, py);
    };
    const double longest = std::max(path_at(*far, sector.lo).hi(), path_at(*far, sector.hi).hi());
    const double least = near == nullptr ? homes_[0].shortest.lo() : least_path(frame, *near);
    for (std::size_t sample = first_; sample < end_; ++sample) {
      if (2 * borders_[sample + 1] < least * (1 - 1e-15)) continue;
      if (2 * borders_[sample] > longest * (1 + 1e-15)) break;
      cut_sample(number, sample, near, *far, sector);
    }
  }
}

/// Appends enclosures of all t at which the line from + u way has this path.
void CertifiedPathCutter::add_roots(const RayFrame& frame, const ApexOverPlane& rx, const Ball& path,
                                    const At& from, const At& way, bool within,
                                    std::vector<Stretch>& at) const {
  const auto relative = [&](const ApexOverPlane& apex) {
    return At{from.x - frame.x_of({apex.x, apex.y}), from.y - frame.y_of({apex.x, apex.y})};
  };
  const At o = relative(tx_), h = relative(rx);
  const Ball path2 = squared(path), out2 = squared(tx_.height) + size2(o.x, o.y),
             home2 = squared(rx.height) + size2(h.x, h.y), along = dot(o.x, o.y, way.x, way.y),
             slope = along - dot(h.x, h.y, way.x, way.y), sum = path2 + out2 - home2;
  const Ball a = Ball(4) * (path2 * size2(way.x, way.y) - squared(slope)),
             b = Ball(4) * path2 * along - Ball(2) * slope * sum, c = Ball(4) * path2 * out2 - squared(sum);
  const Ball discriminant = squared(b) - a * c;
  if (discriminant.surely_negative()) return;
  if (!a.surely_positive() || !discriminant.is_finite()) return at.push_back({-endless, endless});
  const Ball r = root(discriminant), q = b.middle() > 0 ? -(b + r) : r - b;
  const bool direct = q.may_be_zero();
  for (const Ball& u : {direct ? (r - b) / a : q / a, direct ? -(b + r) / a : c / q}) {
    if (within && (u.surely_negative() || (u - Ball(1)).surely_positive())) continue;
    const Ball x = from.x + u * way.x, y = from.y + u * way.y;
    if (x.surely_negative()) continue;
    const Ball t = y / x;
    at.push_back({t.fine_lo(), t.fine_hi()});  // unbounded if x may be 0
  }
}

void CertifiedPathCutter::add_crossings(const RayFrame& frame, const Edge& edge, const ReceiveEnd& rx,
                                        std::size_t border, std::vector<Stretch>& at) const {
  if (rx.ring[border - first_] == Ring::holds_centre)
    add_roots(frame, rx.apex, Ball(2) * Ball(borders_[border]), edge.from,
              {edge.to.x - edge.from.x, edge.to.y - edge.from.y}, true, at);
}

/// Enclosures of t at which ellipses of the two receivers meet. With places p and receiver foot points f
/// relative to the transmitter's foot point, the transmitter's height h and the receiver's height d, an
/// ellipse of path P obeys
///   2 P r_tx = 2 p.f + P^2 + h^2 - d^2 - |f|^2.
/// Eliminating r_tx from two ellipses leaves a straight line.
void CertifiedPathCutter::add_meetings(const RayFrame& frame, std::size_t first_border,
                                       std::size_t second_border, std::vector<Stretch>& at) const {
  if (homes_[0].ring[first_border - first_] != Ring::holds_centre ||
      homes_[1].ring[second_border - first_] != Ring::holds_centre)
    return;
  const Ball path[2] = {Ball(2) * Ball(borders_[first_border]), Ball(2) * Ball(borders_[second_border])};
  const At tx{frame.x_of({tx_.x, tx_.y}), frame.y_of({tx_.x, tx_.y})};
  At foot[2];
  Ball level[2];
  for (int k = 0; k < 2; ++k) {
    const ApexOverPlane& rx = homes_[std::size_t(k)].apex;
    foot[k] = {frame.x_of({rx.x, rx.y}) - tx.x, frame.y_of({rx.x, rx.y}) - tx.y};
    level[k] = squared(path[k]) + squared(tx_.height) - squared(rx.height) - size2(foot[k].x, foot[k].y);
  }
  const Ball nx = Ball(2) * (path[1] * foot[0].x - path[0] * foot[1].x),
             ny = Ball(2) * (path[1] * foot[0].y - path[0] * foot[1].y), n2 = size2(nx, ny),
             offset = path[1] * level[0] - path[0] * level[1];
  // No point of the first ellipse is farther away than its path.
  const Ball farthest = root(n2) * path[0];
  if ((offset - farthest).surely_positive() || (offset + farthest).surely_negative()) return;
  if (!n2.surely_positive()) return at.push_back({-endless, endless});
  const Ball along = -(offset / n2);
  add_roots(frame, homes_[0].apex, path[0], {tx.x + along * nx, tx.y + along * ny}, {-ny, nx}, false, at);
}

void CertifiedPathCutter::cut_sample(std::uint32_t number, std::size_t sample, const Edge* near,
                                     const Edge& far, const Stretch& sector) {
  const RayFrame& frame = frames_[number];
  const auto line = [](const Edge& edge) {
    return PathCurve::line(edge.from.x, edge.from.y, edge.to.x - edge.from.x, edge.to.y - edge.from.y);
  };
  std::vector<PathCurve> lower{near == nullptr ? PathCurve() : line(*near)}, upper{line(far)};
  at_.assign({{sector.lo, sector.lo}, {sector.hi, sector.hi}});
  for (const ReceiveEnd& rx : homes_) {
    if (rx.ring[sample + 1 - first_] != Ring::holds_centre) return;
    for (const std::size_t border : {sample, sample + 1}) {
      if (rx.ring[border - first_] != Ring::holds_centre) continue;
      (border == sample ? lower : upper)
          .push_back(PathCurve::ellipse(frame, tx_, rx.apex, Ball(2) * Ball(borders_[border])));
      add_crossings(frame, far, rx, border, at_);
      if (near != nullptr) add_crossings(frame, *near, rx, border, at_);
    }
  }
  if (homes_.size() > 1)
    for (const std::size_t one : {sample, sample + 1})
      for (const std::size_t two : {sample, sample + 1}) add_meetings(frame, one, two, at_);
  std::erase_if(at_, [&](const Stretch& s) { return s.hi < sector.lo || s.lo > sector.hi; });
  for (Stretch& s : at_) {
    s.lo = std::max(s.lo, sector.lo);
    s.hi = std::min(s.hi, sector.hi);
  }
  merge(at_);

  /// Index of the outermost (`turn` 1) or innermost (`turn` -1) curve. The result holds for the whole
  /// interval. It is x.size() if the comparison is undecided.
  const auto choose = [](const std::vector<Ball>& x, int turn) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < x.size(); ++k)
      if (turn * x[k].middle() > turn * x[best].middle()) best = k;
    for (std::size_t k = 0; k < x.size(); ++k)
      if (k != best && sign(x[best] - x[k]) != turn) return x.size();
    return best;
  };
  const auto decide = [&](const Ball& from, const Ball& to) {
    for (const double part : {0.5, 0.25, 0.75}) {
      const Ball t = (from + (to - from) * Ball(part)).centre();
      std::vector<Ball> low, high;
      for (const PathCurve& curve : lower) low.push_back(curve.at(t));
      for (const PathCurve& curve : upper) high.push_back(curve.at(t));
      for (const Ball& l : low)
        for (const Ball& h : high)
          if (sign(h - l) < 0) return true;  // The cell is empty.
      const std::size_t l = choose(low, 1), h = choose(high, -1);
      if (l == low.size() || h == high.size() || sign(high[h] - low[l]) <= 0) continue;
      cells_.push_back({number, std::uint32_t(sample), lower[l], upper[h], from, to});
      return true;
    }
    return false;
  };
  for (std::size_t k = 0; k < at_.size(); ++k) {
    if (at_[k].hi > at_[k].lo) give_gap(sample, sample + 1, area_of(at_[k].lo, at_[k].hi));
    if (k + 1 < at_.size() && !decide(Ball(at_[k].hi), Ball(at_[k + 1].lo)))
      give_gap(sample, sample + 1, area_of(at_[k].hi, at_[k + 1].lo));
  }
}

}  // namespace tubefoot
