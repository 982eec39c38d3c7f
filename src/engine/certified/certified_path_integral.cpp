// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_path_integral.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/integrals/certified_rule.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t most_halvings = 400;  // of a cell
constexpr int deepest = 90;
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double largest_ellipse = 64, least_ellipse = 1.2;

double most_of(const Ball& x) {
  const double most = std::max(std::abs(x.lo()), std::abs(x.hi()));
  return most < infinite ? most : infinite;  // also where it is not a number
}

/// Parameter of the ellipse about an interval of that half width which reaches so far across it.
double ellipse_reaching(double across, double half) {
  const double s = across / half;
  return std::clamp(s + std::sqrt(s * s + 1), 1.0, largest_ellipse);
}

}  // namespace

template <class N>
CertifiedPathIntegrator::Element<N> CertifiedPathIntegrator::element(const N& near, const N& far, const N& t,
                                                                     const N& v) const {
  const N width = far - near, x = near + v * width;
  auto [px, py] = frame_->place(x, t);
  return {x * width, {std::move(px), std::move(py)}};
}

void CertifiedPathIntegrator::add(const CertifiedPolygon& polygon, const ApexOverPlane& out,
                                  std::span<const ApexOverPlane> homes, CertifiedIntegrand& integrand,
                                  const Allowance& allowance, const Taker& take,
                                  const std::optional<Ball>& unsure) {
  cutter_.cut(polygon, out, homes, unsure);
  if (cutter_.cells().empty() && cutter_.gaps().empty()) return;
  integrand_ = &integrand;
  relative_ = allowance.relative;
  const std::size_t values = integrand.values();

  std::vector<CertifiedPolygon::Point> ends = polygon.points;
  if (cutter_.about_centre()) ends.push_back(cutter_.centre());
  PlanePlace<Ball> box{ends.front().x, ends.front().y};
  for (const CertifiedPolygon::Point& p : ends) {
    arb_union(box.x.get(), box.x.get(), p.x.get(), ball_bits);
    arb_union(box.y.get(), box.y.get(), p.y.get(), ball_bits);
  }
  integrand.take_whole();
  integrand.at(box, values_);
  most_.clear();
  for (const Ball& value : values_) most_.push_back(most_of(value));
  largest_area_ = ((Ball(box.x.hi()) - Ball(box.x.lo())) * (Ball(box.y.hi()) - Ball(box.y.lo()))).hi();

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
  std::vector<std::vector<Ball>> sums(end - first, std::vector<Ball>(values));
  const Ball sign = integrand.positive() ? Ball::between(0, 1) : Ball::between(-1, 1);
  for (const auto& gap : cutter_.gaps())
    for (std::size_t v = 0; v < values; ++v) {
      const Ball part = Ball((gap.area * Ball(most_[v])).hi()) * sign;
      for (std::size_t k = gap.first_sample; k < gap.end_sample; ++k) sums[k - first][v] += part;
    }
  for (const auto& cell : cutter_.cells()) {
    stop_if_wanted();
    allowed_.resize(values);
    for (std::size_t v = 0; v < values; ++v)
      allowed_[v] = allowance.absolute(v, cell.sample) / cells[cell.sample - first];
    sum_.assign(values, Ball());
    integrate(cell);
    for (std::size_t v = 0; v < values; ++v) sums[cell.sample - first][v] += sum_[v];
  }
  for (std::size_t k = first; k < end; ++k) take(k, sums[k - first]);
}

void CertifiedPathIntegrator::integrate(const CertifiedPathCutter::Cell& cell) {
  cell_ = &cell;
  frame_ = &cutter_.frames()[cell.frame];
  work_.assign(1, {cell.from, cell.to, 0, 1, 0});
  std::size_t halved = 0;
  for (std::size_t next = 0; next < work_.size(); ++next) {
    stop_if_wanted();
    const Box box = work_[next];
    if (try_box(box)) continue;
    if (++halved > most_halvings || box.depth >= deepest) {
      integrand_->take_whole();
      try_range(box, true);
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
  const Ball t(box.from + (box.to - box.from) * Ball::between(0, 1)), v = Ball::between(box.v_from, box.v_to);
  const Ball near = cell_->near.at(t), far = cell_->far.at(t);
  const Element<Ball> all = element(near, far, t, v);
  // Which way it is longer.
  const Ball middle = ((box.from + box.to) / Ball(2)).centre();
  const Ball near_there = cell_->near.at(middle), far_there = cell_->far.at(middle);
  const double across = (far_there * (box.to - box.from)).hi(),
               along = ((far_there - near_there) * Ball(box.v_to - box.v_from)).hi();
  split_v_ = along > across;
  // A sliver.
  const double area = (all.area * whole_of(box)).hi();
  bool small = area >= 0;
  const double share = std::sqrt((box.v_to - box.v_from) *
                                 std::min(1.0, ((box.to - box.from) / (cell_->to - cell_->from)).hi()));
  for (std::size_t v_ = 0; v_ < most_.size(); ++v_)
    small = small && area * most_[v_] <= allowed_[v_] * share * share / 4;
  if (small) {
    integrand_->take_whole();
    return try_range(box, true);
  }
  std::vector<double> off(most_.size(), 0);
  if (!all.area.is_finite() || !integrand_->take(all.place, off)) {
    integrand_->take_whole();
    return try_range(box, false);
  }
  return try_rules(box, off);
}

/// Area times range, if that is narrow enough or nothing else is left.
bool CertifiedPathIntegrator::try_range(const Box& box, bool at_any_width) {
  const Ball t(box.from + (box.to - box.from) * Ball::between(0, 1)), v = Ball::between(box.v_from, box.v_to);
  const Element<Ball> all = element(cell_->near.at(t), cell_->far.at(t), t, v);
  const bool positive = integrand_->positive();
  integrand_->at(all.place, values_);
  const Ball whole = whole_of(box), area = all.area * whole;
  const double share =
      whole.hi() / std::max((cell_->to - cell_->from).hi(), std::numeric_limits<double>::min());
  // No more than the polygon's area and largest value, whatever the curves' enclosures say.
  const Ball most_area(std::min(std::isnan(area.hi()) ? infinite : area.hi(), largest_area_));
  for (std::size_t v_ = 0; v_ < values_.size(); ++v_) {
    Ball& value = values_[v_];
    value = area * value;
    const double most = (most_area * Ball(most_[v_])).hi();
    if (!(most_of(value) <= most))
      value = Ball(most) * (positive ? Ball::between(0, 1) : Ball::between(-1, 1));
    if (positive && value.lo() < 0) value = Ball::between(0, std::max(value.hi(), 0.0));
  }
  if (!at_any_width)
    for (std::size_t v_ = 0; v_ < values_.size(); ++v_) {
      const Ball& size = values_[integrand_->size_of(v_)];
      const double least = std::max(std::abs(size.middle()) - (size.hi() - size.lo()), 0.0);
      if (!(values_[v_].hi() - values_[v_].lo() <=
            relative_ * least + allowed_[v_] * std::sqrt(share) * std::sqrt(share)))
        return false;
    }
  for (std::size_t v_ = 0; v_ < values_.size(); ++v_) sum_[v_] += values_[v_];
  return true;
}

bool CertifiedPathIntegrator::try_rules(const Box& box, const std::vector<double>& off) {
  const std::size_t count = most_.size();
  const Ball half = (box.to - box.from) / Ball(2), middle = box.from + half;
  const double v_half = (box.v_to - box.v_from) / 2, v_middle = box.v_from + v_half, width = half.hi();
  if (!(width > 0)) return true;
  const Ball near = cell_->near.at(middle), far = cell_->far.at(middle);
  const Ball v_ball(v_middle);
  const Element<Ball> typical = element(near, far, middle, v_ball);
  integrand_->at(typical.place, values_);
  const Ball whole = whole_of(box);
  const double share = std::min(1.0, (whole / (cell_->to - cell_->from)).hi());
  std::vector<double> allowed(count);
  for (std::size_t v = 0; v < count; ++v) {
    const double there = std::abs((values_[integrand_->size_of(v)] * typical.area * whole).middle());
    allowed[v] = (relative_ * there + allowed_[v] * share) / 2;
    if (off[v] > 0 && !(off[v] < 1 && std::expm1(off[v]) * there <= allowed[v])) return false;
  }

  // How far places may move into the complex: a part of their distance to the nearer apex is looked for.
  const double x = std::abs(typical.area.middle() / (far - near).middle()), depth = (far - near).middle();
  const double scale = std::max(integrand_->scale_m(typical.place), 1e-12);
  std::vector<double> bounds;
  struct Choice {
    int nodes = most_certified_nodes + 1;
    double rho = 0;
    std::vector<double> log_m;
  };
  const auto choose = [&](double first_rho, const auto& evaluate) {
    Choice best;
    for (double rho = first_rho; rho > least_ellipse; rho = 1 + (rho - 1) / 3) {
      evaluate(rho);
      double worst = -infinite;
      for (const double bound : bounds) worst = std::isnan(bound) ? infinite : std::max(worst, bound);
      if (!(worst < infinite)) continue;
      int n = fewest_certified_nodes;
      for (std::size_t v = 0; v < count; ++v)
        n = std::max(n, nodes_for(rho, bounds[v] + std::log(4 * width * v_half), allowed[v] / 2));
      if (n < best.nodes)
        best = {n, rho, bounds};
      else if (best.nodes <= most_certified_nodes)
        break;
    }
    return best;
  };
  const auto bound = [&](const ComplexBall& t, const ComplexBall& v, const ComplexBall& near_there,
                         const ComplexBall& far_there) {
    const Element<ComplexBall> all = element(near_there, far_there, t, v);
    const double log_area = std::log(all.area.largest());
    if (!(log_area < infinite)) {
      bounds.assign(count, infinite);
      return;
    }
    integrand_->log_bounds(all.place, bounds);
    for (double& one : bounds) one += log_area;
  };
  const Ball all_t = middle + half * Ball::between(-1, 1);
  const ComplexBall all_v(v_ball + Ball(v_half) * Ball::between(-1, 1));
  const Choice in_t = choose(ellipse_reaching(0.5 * scale / x, width), [&](double rho) {
    const ComplexBall t = around(middle, half, rho);
    bound(t, all_v, cell_->near.at(t), cell_->far.at(t));
  });
  const ComplexBall near_all(cell_->near.at(all_t)), far_all(cell_->far.at(all_t));
  const Choice in_v = choose(ellipse_reaching(0.5 * scale / depth, v_half), [&](double rho) {
    bound(ComplexBall(all_t), around(v_ball, Ball(v_half), rho), near_all, far_all);
  });
  if (in_t.nodes > most_certified_nodes || in_v.nodes > most_certified_nodes) {
    if (in_t.nodes <= most_certified_nodes)
      split_v_ = box.depth % 2 == 1;
    else if (in_v.nodes <= most_certified_nodes)
      split_v_ = false;
    return false;
  }
  const CertifiedRule &rule_t = certified_rule(in_t.nodes), &rule_v = certified_rule(in_v.nodes);
  std::vector<Ball> own(count);
  for (int i = 0; i < in_t.nodes; ++i) {
    const Ball t = middle + half * rule_t.node[std::size_t(i)], near_there = cell_->near.at(t),
               far_there = cell_->far.at(t);
    for (int k = 0; k < in_v.nodes; ++k) {
      const Element<Ball> there =
          element(near_there, far_there, t, v_ball + Ball(v_half) * rule_v.node[std::size_t(k)]);
      integrand_->at(there.place, values_);
      const Ball weight = rule_t.weight[std::size_t(i)] * rule_v.weight[std::size_t(k)] * there.area;
      for (std::size_t v = 0; v < count; ++v) own[v] += weight * values_[v];
    }
  }
  const Ball scaled = half * Ball(v_half);
  for (std::size_t v = 0; v < count; ++v) {
    own[v] = own[v] * scaled;
    // The rule in t errs for every v, the rule in v for every t; weights are positive and add up to 2.
    for (const Choice* c : {&in_t, &in_v})
      own[v].add_error(Ball(2) * scaled * exp(Ball(c->log_m[v] + log_error(c->rho, c->nodes))));
    if (!own[v].is_finite()) return false;
  }
  for (std::size_t v = 0; v < count; ++v) {
    // Of a positive integrand, the integral is wrong by no more, relatively, than the integrand.
    if (off[v] > 0)
      own[v].add_error(Ball(most_of(own[integrand_->size_of(v)])) * (exp(Ball(off[v])) - Ball(1)));
    sum_[v] += own[v];
  }
  return true;
}

}  // namespace tubefoot
