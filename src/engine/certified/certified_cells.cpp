// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/numbers/enclosure_slack.hpp"
#include "geometry/steps/stop.hpp"

// Cuts certified polygons along the planes between texture cells and evaluates the texture factor in each
// part. Neighbouring parts share one chord, so that the parts make up exactly the polygon. See
// docs/notes/certified-energies.md, section "Micro-texture".
namespace tubefoot {
namespace {

using Points = std::vector<CertifiedPolygon::Point>;

/// A corner whose height above a plane between cells is below this counts as lying in the plane, in cells.
/// It is far above the rounding of corners, and far below the resolution of any tolerance.
constexpr double level = 1e-18;
constexpr double largest_coordinate = 0x1p50;
constexpr double least_bound = 1e-300;  // positive, so that its logarithm exists
constexpr double largest_off = 0.01;

class Cutter {
 public:
  Cutter(const CertifiedPolygon& polygon, const CertifiedTexture& texture, const FacetMap& lies,
         const TexturedPolygon::Take& sink)
      : polygon_(polygon), sink_(sink) {
    cell_.texture = &texture;
    const auto balls = [](const glm::dvec3& p) {
      return std::array<Ball, 3>{Ball(p.x), Ball(p.y), Ball(p.z)};
    };
    // Maps vectors of apparent positions to vectors of true positions.
    const auto two_way = [&](const std::array<Ball, 3>& e) {
      std::array<Ball, 3> on;
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) on[row] += Ball(lies.linear[column][row]) * e[column];
      return on;
    };
    const std::array<Ball, 3> at = balls(lies.lies_m), from = two_way(balls(lies.seen_m)),
                              away = two_way(polygon.away), u = two_way(polygon.u), v = two_way(polygon.v);
    for (const CertifiedTexture::Axis& axis : texture.axes()) {
      const auto along = [&](const std::array<Ball, 3>& e) {
        return axis.per_m[0] * e[0] + axis.per_m[1] * e[1] + axis.per_m[2] * e[2];
      };
      cell_.traces.push_back(
          {along(at) + along(away) * polygon.distance + axis.origin - along(from), along(u), along(v)});
      cell_.traces_in_doubles.push_back(in_doubles(cell_.traces.back()));
    }
    cell_.cell.resize(cell_.traces.size());
  }

  std::size_t cut() {
    cut(polygon_.points, 0);
    return failed_ ? 0 : count_;
  }

 private:
  std::vector<Ball> coordinates(const Points& points, std::size_t axis) const {
    std::vector<Ball> q;
    for (const CertifiedPolygon::Point& p : points) q.push_back(cell_.traces[axis].at(p.x, p.y));
    return q;
  }

  void cut(const Points& points, std::size_t axis) {
    stop_if_wanted();
    if (failed_) return;
    if (axis == cell_.traces.size()) {
      failed_ = ++count_ > most_cells;
      if (!failed_ && sink_) give(points);
      return;
    }
    const std::vector<Ball> q = coordinates(points, axis);
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const Ball& x : q) {
      lo = std::min(lo, x.lo());
      hi = std::max(hi, x.hi());
    }
    const double first = std::floor(lo) + 1, last = std::ceil(hi) - 1;
    if (!(lo > -largest_coordinate && hi < largest_coordinate && last - first <= double(most_cells))) {
      failed_ = true;
      return;
    }
    const auto cut_at = [&](double plane) {
      std::vector<Ball> height;
      for (const Ball& x : q) height.push_back(x - Ball(plane));
      const auto sides = split(points, height, level);
      if (sides[0].empty() || sides[1].empty()) return false;
      for (const Points& side : sides) cut(side, axis);
      return true;
    };
    if (first <= last && cut_at(std::floor((first + last) / 2))) return;
    // The outermost planes may only touch the polygon.
    for (double plane = first; plane <= last; ++plane)
      if (cut_at(plane)) return;
    cell_.cell[axis] = std::int64_t(std::floor(lo + (hi - lo) / 2));
    cut(points, axis + 1);
  }

  void give(const Points& points) {
    double off = 0;
    for (std::size_t axis = 0; axis < cell_.traces.size(); ++axis)
      for (const Ball& q : coordinates(points, axis)) {
        const Ball x = q - Ball(double(cell_.cell[axis]));
        off = std::max({off, -x.lo(), (x - Ball(1)).hi()});
      }
    const Ball range = cell_.texture->range();
    const double slack =
        off <= largest_off ? cell_.texture->difference(off) : (Ball(range.hi()) - Ball(range.lo())).hi();
    cell_.slack = Ball(slack) * Ball::between(-1, 1);
    sink_(part_of(polygon_, points), &cell_);
  }

  const CertifiedPolygon& polygon_;
  std::size_t count_ = 0;
  const TexturedPolygon::Take& sink_;
  CertifiedCell cell_;
  bool failed_ = false;
};

template <class Trace, class N>
std::vector<N> coordinates_at(const std::vector<Trace>& traces, const N& x, const N& y) {
  std::vector<N> q;
  for (const Trace& trace : traces) q.push_back(trace.at(x, y));
  return q;
}

}  // namespace

Ball CertifiedCell::factor(const Ball& rho, const Ball& angle) const {
  Ball sine, cosine;
  sin_cos(angle, sine, cosine);
  return factor_at(rho * cosine, rho * sine);
}

double CertifiedCell::largest(const ComplexBall& rho, const ComplexBall& angle) const {
  ComplexBall sine, cosine;
  sin_cos(angle, sine, cosine);
  return largest_at(rho * cosine, rho * sine);
}

Ball CertifiedCell::factor_at(const Ball& x, const Ball& y) const {
  return texture->factor(cell, coordinates_at(traces, x, y)) + slack;
}

Interval CertifiedCell::factor_at(const Interval& x, const Interval& y) const {
  return texture->factor(cell, coordinates_at(traces_in_doubles, x, y)) + interval_of(slack);
}

double CertifiedCell::largest_at(const ComplexBall& x, const ComplexBall& y) const {
  return std::max(texture->largest(cell, coordinates_at(traces, x, y)), least_bound);
}

TexturedPolygon::TexturedPolygon(const CertifiedPolygon& polygon, const CertifiedTexture* texture,
                                 const FacetMap& lies, double tolerance)
    : polygon_(polygon), texture_(texture), lies_(lies) {
  if (texture == nullptr) return;
  range_ = texture->range();
  varies_ = polygon.edges.size() >= 3 && range_.hi() - range_.lo() > tolerance / 8 * range_.lo();
  if (varies_) cells_ = cut({});
}

void TexturedPolygon::each_part(const Take& take) const {
  if (is_cut())
    cut(take);
  else
    take(polygon_, nullptr);
}

double TexturedPolygon::change_over(double distance_m) const {
  if (!is_cut() || !(distance_m > 0)) return 0;
  double per_m = 0;
  for (const CertifiedTexture::Axis& axis : texture_->axes())
    per_m =
        std::max(per_m, root(squared(axis.per_m[0]) + squared(axis.per_m[1]) + squared(axis.per_m[2])).hi());
  return std::min(texture_->change(per_m * distance_m * (1 + enclosure_slack)), range_.hi());
}

/// Returns the number of parts, or 0 if there are too many. Without `take`, the parts are only counted.
std::size_t TexturedPolygon::cut(const Take& take) const {
  return Cutter(polygon_, *texture_, lies_, take).cut();
}

}  // namespace tubefoot
