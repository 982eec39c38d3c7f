// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_path_integral.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "geometry/integrals/certified_rule.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/stop.hpp"

// Integrates over cells between ellipses of equal path length by two-dimensional Gauss-Legendre quadrature,
// first in intervals of doubles and then in balls. See docs/notes/certified-energies.md, section "Two
// apexes".
namespace tubefoot {
namespace {

constexpr std::size_t most_cell_halvings = 400;  // per cell
constexpr int deepest_cell = 90;
constexpr double largest_ellipse = 64, least_ellipse = 1.2;

double most_of(const Ball& x) {
  const double most = std::max(std::abs(x.lo()), std::abs(x.hi()));
  return most < infinite ? most : infinite;  // also if the value is not a number
}

// Common functions of balls and intervals.
double lower(const Ball& x) { return x.lo(); }
double upper(const Ball& x) { return x.hi(); }
double middle_of(const Ball& x) { return x.middle(); }
double lower(const Interval& x) { return x.lo; }
double upper(const Interval& x) { return x.hi; }
double middle_of(const Interval& x) { return x.middle(); }
double most_of(const Interval& x) {
  const double most = x.largest();
  return most < infinite ? most : infinite;
}
template <class N>
N between(double lo, double hi) {
  if constexpr (std::is_same_v<N, Ball>)
    return Ball::between(lo, hi);
  else
    return Interval(lo, hi);
}
template <class N>
N as(const Ball& x) {
  if constexpr (std::is_same_v<N, Ball>)
    return x;
  else
    return interval_of(x);
}
const std::vector<Ball>& nodes_of(const CertifiedRule& rule, const Ball&) { return rule.node; }
const std::vector<Interval>& nodes_of(const CertifiedRule& rule, const Interval&) {
  return rule.node_in_doubles;
}
const std::vector<Ball>& weights_of(const CertifiedRule& rule, const Ball&) { return rule.weight; }
const std::vector<Interval>& weights_of(const CertifiedRule& rule, const Interval&) {
  return rule.weight_in_doubles;
}
/// Share of the permitted error that the rounding of doubles may use.
constexpr double rounding_share = 1.0 / 8;
/// If balls exceed this share too, intervals of positions may be at most this much wider than balls.
constexpr double most_wider = 4;

/// Parameter of the ellipse about an interval of half-width `half` that reaches `across` into the imaginary
/// direction.
double ellipse_reaching(double across, double half) {
  const double s = across / half;
  return std::clamp(s + std::sqrt(s * s + 1), 1.0, largest_ellipse);
}

}  // namespace

template <>
std::vector<Ball>& CertifiedPathIntegrator::values_in<Ball>() {
  return values_;
}
template <>
std::vector<Interval>& CertifiedPathIntegrator::values_in<Interval>() {
  return values_in_doubles_;
}

template <class N>
CertifiedPathIntegrator::Element<N> CertifiedPathIntegrator::element(const N& near, const N& far, const N& t,
                                                                     const N& v) const {
  const N width = far - near, x = near + v * width;
  if constexpr (std::is_same_v<N, ComplexBall>) {
    auto [px, py] = frame_->place(x, t);
    return {x * width, {std::move(px), std::move(py)}};
  } else {
    auto [px, py] = frame_in(t).place(x, t);
    return {x * width, {std::move(px), std::move(py)}};
  }
}

template <class N>
CertifiedPathIntegrator::Element<N> CertifiedPathIntegrator::over(const Box& box) const {
  const N t = between<N>(box.from.lo(), box.to.hi()), v = between<N>(box.v_from, box.v_to);
  return element(near_at(t), far_at(t), t, v);
}

void CertifiedPathIntegrator::add(const CertifiedPolygon& polygon, const ApexOverPlane& out,
                                  std::span<const ApexOverPlane> homes, CertifiedIntegrand& integrand,
                                  const Allowance& allowance, const Taker& take,
                                  const std::optional<Ball>& ambiguous) {
  std::vector<Ball> balls;
  const IntervalTaker as_balls = [&](std::size_t sample, std::span<const Interval> values) {
    balls.clear();
    for (const Interval& value : values) balls.push_back(Ball::between(value.lo, value.hi));
    take(sample, balls);
  };
  add(polygon, out, homes, integrand, allowance, as_balls, ambiguous);
}

void CertifiedPathIntegrator::add(const CertifiedPolygon& polygon, const ApexOverPlane& out,
                                  std::span<const ApexOverPlane> homes, CertifiedIntegrand& integrand,
                                  const Allowance& allowance, const IntervalTaker& take,
                                  const std::optional<Ball>& ambiguous) {
  cutter_.cut(polygon, out, homes, ambiguous);
  if (cutter_.cells().empty() && cutter_.gaps().empty()) return;
  integrand_ = &integrand;
  relative_ = allowance.relative;
  const std::size_t values = integrand.values();

  std::vector<CertifiedPolygon::Point> ends = polygon.points;
  if (cutter_.about_centre()) ends.push_back(cutter_.centre());
  PlanePlace<Interval> box{interval_of(ends.front().x), interval_of(ends.front().y)};
  for (const CertifiedPolygon::Point& p : ends)
    box = {hull(box.x, interval_of(p.x)), hull(box.y, interval_of(p.y))};
  integrand.take_whole();
  most_.clear();
  in_doubles_ = integrand.at(box, values_in_doubles_);
  if (in_doubles_) {
    for (const Interval& value : values_in_doubles_) most_.push_back(most_of(value));
  } else {
    integrand.at({Ball::between(box.x.lo, box.x.hi), Ball::between(box.y.lo, box.y.hi)}, values_);
    for (const Ball& value : values_) most_.push_back(most_of(value));
  }
  largest_area_ = (Interval(box.x.width()) * Interval(box.y.width()) * (1 + 1e-15)).hi;

  std::size_t first = std::numeric_limits<std::size_t>::max(), end = 0;
  for (const auto& cell : cutter_.cells()) {
    first = std::min<std::size_t>(first, cell.sample);
    end = std::max<std::size_t>(end, cell.sample + 1);
  }
  for (const auto& gap : cutter_.gaps()) {
    first = std::min<std::size_t>(first, gap.first_sample);
    end = std::max<std::size_t>(end, gap.end_sample);
  }
  std::vector<double> cells(end - first, 0);
  for (const auto& cell : cutter_.cells()) ++cells[cell.sample - first];
  std::vector<std::vector<Interval>> sums(end - first, std::vector<Interval>(values));
  const double least = integrand.positive() ? 0 : -1;
  for (const auto& gap : cutter_.gaps()) {
    const double area = gap.area.hi();
    for (std::size_t v = 0; v < values; ++v) {
      const double most = (Interval(area) * most_[v]).hi;
      for (std::size_t k = gap.first_sample; k < gap.end_sample; ++k)
        sums[k - first][v] += Interval(least * most, most);
    }
  }
  for (const auto& cell : cutter_.cells()) {
    stop_if_wanted();
    allowed_.resize(values);
    for (std::size_t v = 0; v < values; ++v)
      allowed_[v] = allowance.absolute(v, cell.sample) / cells[cell.sample - first];
    sum_in_doubles_.assign(values, Interval());
    in_balls_ = false;
    integrate(cell);
    for (std::size_t v = 0; v < values; ++v) {
      Interval& sum = sums[cell.sample - first][v];
      sum += sum_in_doubles_[v];
      if (in_balls_) sum += interval_of(sum_[v]);
    }
  }
  for (std::size_t k = first; k < end; ++k) take(k, sums[k - first]);
}

void CertifiedPathIntegrator::integrate(const CertifiedPathCutter::Cell& cell) {
  cell_ = &cell;
  frame_ = &cutter_.frames()[cell.frame];
  own_frame_ = in_doubles(*frame_);
  near_ = cell.near.in_doubles();
  far_ = cell.far.in_doubles();
  sum_.assign(most_.size(), Ball());
  work_.assign(1, {cell.from, cell.to, 0, 1, 0});
  std::size_t halved = 0;
  for (std::size_t next = 0; next < work_.size(); ++next) {
    stop_if_wanted();
    const Box box = work_[next];
    if (try_box(box)) continue;
    if (++halved > most_cell_halvings || box.depth >= deepest_cell) {
      integrand_->take_whole();
      try_range(box, over<Ball>(box), true);
      ++given_up_;
      continue;
    }
    halve(box);
  }
}

void CertifiedPathIntegrator::halve(const Box& box) {
  Box first = box, second = box;
  first.depth = second.depth = box.depth + 1;
  if (split_v_)
    first.v_to = second.v_from = (box.v_from + box.v_to) / 2;
  else
    first.to = second.from = ((box.from + box.to) / Ball(2)).centre();
  work_.push_back(std::move(first));
  work_.push_back(std::move(second));
}

bool CertifiedPathIntegrator::try_box(const Box& box) {
  if (in_doubles_) {
    const Outcome outcome = try_box_in<Interval>(box);
    if (outcome != Outcome::unknown) return outcome == Outcome::done;
  }
  return try_box_in<Ball>(box) == Outcome::done;
}

template <class N>
CertifiedPathIntegrator::Outcome CertifiedPathIntegrator::try_box_in(const Box& box) {
  const Element<N> all = over<N>(box);
  // Compares the two extents of the box; the longer one is halved.
  const N middle = as<N>(((box.from + box.to) / Ball(2)).centre()), near = near_at(middle),
          far = far_at(middle);
  const N width = as<N>(box.to - box.from);
  const double across = upper(far * width), along = upper((far - near) * N(box.v_to - box.v_from));
  split_v_ = along > across;
  // A sliver is enclosed by its range.
  const double area = upper(all.area * as<N>(whole_of(box)));
  bool small = area >= 0;
  const double share = std::sqrt((box.v_to - box.v_from) *
                                 std::min(1.0, ((box.to - box.from) / (cell_->to - cell_->from)).hi()));
  for (std::size_t v = 0; v < most_.size(); ++v)
    small = small && area * most_[v] <= allowed_[v] * share * share / 4;
  if (small) {
    integrand_->take_whole();
    return try_range(box, all, true);
  }
  std::vector<double> off(most_.size(), 0);
  const auto take = [&] {
    if constexpr (std::is_same_v<N, Ball>) return integrand_->take(all.place, off);
    return integrand_->take({Ball::between(lower(all.place.x), upper(all.place.x)),
                             Ball::between(lower(all.place.y), upper(all.place.y))},
                            off);
  };
  if (!(std::abs(lower(all.area)) < infinite && std::abs(upper(all.area)) < infinite) || !take()) {
    integrand_->take_whole();
    return try_range(box, all, false);
  }
  return try_rules<N>(box, off);
}

/// Adds area times range, if it is narrow enough, or in any case with `at_any_width`.
template <class N>
CertifiedPathIntegrator::Outcome CertifiedPathIntegrator::try_range(const Box& box, const Element<N>& all,
                                                                    bool at_any_width) {
  std::vector<N>& values = values_in<N>();
  const bool positive = integrand_->positive();
  if (!evaluate(all.place, values)) return Outcome::unknown;
  const Ball whole = whole_of(box);
  const N area = all.area * as<N>(whole);
  const double share =
      whole.hi() / std::max((cell_->to - cell_->from).hi(), std::numeric_limits<double>::min());
  // The result never exceeds the polygon's area times the largest value, whatever the enclosures of the
  // curves are.
  const double area_hi = upper(area),
               most_area = std::min(std::isnan(area_hi) ? infinite : area_hi, largest_area_);
  for (std::size_t v = 0; v < values.size(); ++v) {
    N& value = values[v];
    value = area * value;
    const double most = upper(N(most_area) * N(most_[v]));
    if (!(most_of(value) <= most)) value = N(most) * between<N>(positive ? 0 : -1, 1);
    if (positive && lower(value) < 0) value = between<N>(0, std::max(upper(value), 0.0));
  }
  if (!at_any_width)
    for (std::size_t v = 0; v < values.size(); ++v) {
      const N& size = values[integrand_->size_of(v)];
      const double least = std::max(std::abs(middle_of(size)) - (upper(size) - lower(size)), 0.0);
      if (!(upper(values[v]) - lower(values[v]) <=
            relative_ * least + allowed_[v] * std::sqrt(share) * std::sqrt(share)))
        return Outcome::too_wide;
    }
  for (std::size_t v = 0; v < values.size(); ++v) add_to_sum(v, values[v]);
  return Outcome::done;
}

template <class Evaluate>
CertifiedPathIntegrator::Choice CertifiedPathIntegrator::choose(double first_rho, double size,
                                                                const std::vector<double>& log_allowed,
                                                                const Evaluate& evaluate) {
  std::vector<double> bounds;
  Choice best{most_certified_nodes + 1, 0, {}};
  const double log_size = std::log(size);
  for (double rho = first_rho; rho > least_ellipse; rho = 1 + (rho - 1) / 3) {
    evaluate(rho, bounds);
    // The value that requires most nodes is the one whose bound exceeds its permitted error by the largest
    // ratio.
    double worst = -1000;  // logarithm
    for (std::size_t v = 0; v < bounds.size(); ++v) {
      const double excess = bounds[v] + log_size - log_allowed[v];
      worst = std::isnan(excess) ? infinite : std::max(worst, excess);
    }
    if (!(worst < infinite)) continue;
    const int nodes = std::max(fewest_certified_nodes, nodes_for(rho, worst, 1));
    if (nodes < best.nodes)
      best = {nodes, rho, bounds};
    else if (best.nodes <= most_certified_nodes)
      break;
  }
  return best;
}

/// Returns false if the integrand has no values of this type.
template <class N>
bool CertifiedPathIntegrator::sum_nodes(const Box& box, int nodes_t, int nodes_v, std::vector<N>& sum) {
  const N half = as<N>((box.to - box.from) / Ball(2)), first = as<N>(box.from), middle = first + half;
  const double v_half = (box.v_to - box.v_from) / 2, v_middle = box.v_from + v_half;
  const CertifiedRule &rule_t = certified_rule(nodes_t), &rule_v = certified_rule(nodes_v);
  const std::vector<N>&at_t = nodes_of(rule_t, half), &at_v = nodes_of(rule_v, half),
        &weight_t = weights_of(rule_t, half), &weight_v = weights_of(rule_v, half);
  std::vector<N>& values = values_in<N>();
  sum.assign(most_.size(), N());
  for (std::size_t i = 0; i < at_t.size(); ++i) {
    const N t = middle + half * at_t[i], near = near_at(t), far = far_at(t);
    for (std::size_t k = 0; k < at_v.size(); ++k) {
      const Element<N> there = element(near, far, t, N(v_middle) + N(v_half) * at_v[k]);
      if (!evaluate(there.place, values)) return false;
      const N weight = weight_t[i] * weight_v[k] * there.area;
      for (std::size_t v = 0; v < values.size(); ++v) sum[v] += weight * values[v];
    }
  }
  const N scaled = half * N(v_half);
  for (N& value : sum) value = value * scaled;
  return true;
}

template <class N>
CertifiedPathIntegrator::Outcome CertifiedPathIntegrator::try_rules(const Box& box,
                                                                    const std::vector<double>& off) {
  constexpr bool doubles = std::is_same_v<N, Interval>;
  const std::size_t count = most_.size();
  const Ball half = (box.to - box.from) / Ball(2), middle = box.from + half;
  const double v_half = (box.v_to - box.v_from) / 2, v_middle = box.v_from + v_half, width = half.hi();
  if (!(width > 0)) return Outcome::done;
  const Ball v_ball(v_middle);
  const N t_middle = as<N>(middle), near = near_at(t_middle), far = far_at(t_middle);
  const Element<N> typical = element(near, far, t_middle, N(v_middle));
  std::vector<N>& values = values_in<N>();
  if (!evaluate(typical.place, values)) return Outcome::unknown;
  const Ball whole = whole_of(box);
  const double share = std::min(1.0, (whole / (cell_->to - cell_->from)).hi());
  std::vector<double> allowed(count), log_allowed(count);
  const N area = typical.area * as<N>(whole);
  for (std::size_t v = 0; v < count; ++v) {
    const double there = std::abs(middle_of(values[integrand_->size_of(v)] * area));
    allowed[v] = (relative_ * there + allowed_[v] * share) / 2;
    log_allowed[v] = std::log(allowed[v] / 2);
    if (off[v] > 0 && !(off[v] < 1 && std::expm1(off[v]) * there <= allowed[v])) return Outcome::too_wide;
  }

  // Distance that points may move into the complex plane. It is a part of their distance to the nearer apex.
  const double depth = middle_of(far - near), x = std::abs(middle_of(typical.area) / depth);
  const double scale = std::max(
      integrand_->scale_m({Ball(middle_of(typical.place.x)), Ball(middle_of(typical.place.y))}), 1e-12);
  const auto bound = [&](const ComplexBall& t, const ComplexBall& v, const ComplexBall& near_there,
                         const ComplexBall& far_there, std::vector<double>& bounds) {
    const Element<ComplexBall> there = element(near_there, far_there, t, v);
    const double log_area = std::log(there.area.largest());
    if (!(log_area < infinite)) {
      bounds.assign(count, infinite);
      return;
    }
    integrand_->log_bounds(there.place, bounds);
    for (double& one : bounds) one += log_area;
  };
  const Ball all_t = middle + half * Ball::between(-1, 1);
  const ComplexBall all_v(v_ball + Ball(v_half) * Ball::between(-1, 1));
  const double size = 4 * width * v_half;
  const Choice in_t = choose(ellipse_reaching(0.5 * scale / x, width), size, log_allowed,
                             [&](double rho, std::vector<double>& bounds) {
                               const ComplexBall t = around(middle, half, rho);
                               bound(t, all_v, cell_->near.at(t), cell_->far.at(t), bounds);
                             });
  const ComplexBall near_all(cell_->near.at(all_t)), far_all(cell_->far.at(all_t));
  const Choice in_v =
      choose(ellipse_reaching(0.5 * scale / depth, v_half), size, log_allowed,
             [&](double rho, std::vector<double>& bounds) {
               bound(ComplexBall(all_t), around(v_ball, Ball(v_half), rho), near_all, far_all, bounds);
             });
  if (in_t.nodes > most_certified_nodes || in_v.nodes > most_certified_nodes) {
    if (in_t.nodes <= most_certified_nodes)
      split_v_ = box.depth % 2 == 1;
    else if (in_v.nodes <= most_certified_nodes)
      split_v_ = false;
    return Outcome::too_wide;
  }
  std::vector<N> own;
  if (!sum_nodes(box, in_t.nodes, in_v.nodes, own)) return Outcome::unknown;
  if constexpr (doubles) {
    bool narrow = true;
    for (std::size_t v = 0; v < count; ++v) narrow = narrow && own[v].width() <= rounding_share * allowed[v];
    // If corners are inaccurate, balls are no narrower than doubles.
    const auto width_of = [](const Ball& ball) { return ball.hi() - ball.lo(); };
    if (!narrow && !(near.width() + far.width() <=
                     most_wider * (width_of(cell_->near.at(middle)) + width_of(cell_->far.at(middle)))))
      return Outcome::unknown;
  }
  for (std::size_t v = 0; v < count; ++v) {
    // The rule in t has its error for every v, and the rule in v for every t. Weights are positive and add
    // up to 2.
    double error = 0;
    for (const Choice* c : {&in_t, &in_v})
      error += size / 2 * std::exp(c->log_m[v] + log_error(c->rho, c->nodes)) * (1 + 1e-9);
    own[v] = own[v] + between<N>(-error, error);
    if (!(std::abs(lower(own[v])) < infinite && std::abs(upper(own[v])) < infinite)) return Outcome::too_wide;
  }
  for (std::size_t v = 0; v < count; ++v) {
    // For a positive integrand, the relative error of the integral is at most that of the integrand.
    if (off[v] > 0) {
      const double most = most_of(own[integrand_->size_of(v)]) * std::expm1(off[v]) * (1 + 1e-9);
      add_to_sum(v, own[v] + between<N>(-most, most));
    } else {
      add_to_sum(v, own[v]);
    }
  }
  return Outcome::done;
}

}  // namespace tubefoot
