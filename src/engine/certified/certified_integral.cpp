// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_integral.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/integrals/certified_rule.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/stop.hpp"

// Integrates certified polygons for one apex by Gauss-Legendre quadrature in ball arithmetic, slab by slab,
// with the error bound of L. N. Trefethen (Approximation Theory and Approximation Practice, theorem 19.3).
// See docs/notes/certified-energies.md, section "Error of the quadrature".
namespace tubefoot {
namespace {

constexpr std::size_t most_slab_halvings = 500, most_slab_halvings_with_table = 20000;  // per slab
constexpr int deepest = 90;

}  // namespace

CertifiedIntegrator::CertifiedIntegrator(std::span<const double> borders_m, const Ball& beta_per_m)
    : PolarIntegrand(beta_per_m), borders_(borders_m) {}

void CertifiedIntegrator::add(const CertifiedPolygon& polygon, std::uint32_t beam, const Allowance& allowance,
                              const Sink<Ball>& sink, const CertifiedCell* texture) {
  weighed_ = texture != nullptr;
  texture_ = texture;
  tabulated_ = false;
  largest_gain_ = Ball(1);
  if (texture != nullptr) {
    static const Directivity even;
    transmit_.assign(1, cosine_of(even, polygon));
    receive_.assign(1, cosine_of(even, polygon));
    largest_gain_ = Ball(texture->texture->range().hi());
  }
  add(polygon, beam, beam + 1, allowance, sink);
}

void CertifiedIntegrator::add(const CertifiedPolygon& polygon, std::uint32_t first_beam,
                              std::uint32_t end_beam, const Allowance& allowance, const Sink<Ball>& sink) {
  if (polygon.edges.size() < 3) return;  // as thin as a line, even with this number of bits
  take_polygon(polygon);
  slabs_.cut(polygon.ranges, polygon.foot, polygon.foot_inside, borders_);
  corners_.clear();
  for (const PolarSlabs::Slab& slab : slabs_.slabs()) {
    stop_if_wanted();
    parts_.resize(end_beam - first_beam);
    for (std::uint32_t beam = first_beam; beam < end_beam; ++beam)
      parts_[beam - first_beam] = {Ball(), allowance.absolute(beam, slab.sample)};
    take_sample(slab.sample);
    const bool clear = prepare(slabs_.crossings(slab), slab);
    integrate_slab(slab, clear, allowance.relative);
    for (std::uint32_t beam = first_beam; beam < end_beam; ++beam)
      sink({beam, slab.sample, parts_[beam - first_beam].sum});
  }
  const auto enclose_gap = [&](const PolarSlabs::Gap& gap) {
    // The bound is the density times the area between the two circles. The arcs of a circle in a convex
    // polygon are part of the boundary of an intersection. Their length is therefore at most the polygon's
    // perimeter.
    const Ball r = Ball::between(double(gap.lo) * (1 - 1e-15), double(gap.hi) * (1 + 1e-15)),
               rho = root(squared(r) - distance2_);
    const double turn = 2 * Ball::pi().hi(), by_perimeter = (polygon.perimeter / rho).hi();
    const Ball angle(by_perimeter < turn ? by_perimeter : turn);  // also if the value is not a number
    take_sample(gap.first_sample);
    const Ball area = (Ball(gap.hi) - Ball(gap.lo)) * angle * r;
    const Ball most = area * most_density(r, r) * largest_gain_;
    const Ball part = Ball(most.hi()) * Ball::between(0, 1);
    for (std::uint32_t sample = gap.first_sample; sample < gap.end_sample; ++sample)
      for (std::uint32_t beam = first_beam; beam < end_beam; ++beam) sink({beam, sample, part});
  };
  for (const PolarSlabs::Gap& gap : slabs_.gaps()) enclose_gap(gap);
  for (const PolarSlabs::Gap& gap : corners_) enclose_gap(gap);
}

void CertifiedIntegrator::take_sample(std::size_t sample) {
  if (density_ != Density::volume) return;
  for (std::size_t k = starts_.size(); k + 1 < borders_.size(); ++k)
    starts_.push_back(volume_primitive(Ball(borders_[k]), beta_));
  start_ = starts_[sample];
}

void CertifiedIntegrator::integrate_slab(const PolarSlabs::Slab& slab, bool clear, double relative) {
  if (model_ != nullptr)
    for (Part& p : parts_) p.allowed /= double(model_->pieces().size());
  each_piece(slab, [&](long double lo, long double hi) {
    if (!(hi > lo)) return true;
    const Ball t0 = t_at(Ball(lo)), t1 = t_at(Ball(hi));
    if (clear)
      integrate(t0, t1, relative);
    else
      enclose({t0, t1, 0});
    return true;
  });
}

double CertifiedIntegrator::nearest_singularity() const {
  const double q2 = q2_.middle(), d2 = distance2_.middle();
  if (full_circle_) return std::sqrt(d2);
  double nearest2 = q2 - d2;
  for (const Arc& arc : arcs_)
    for (const std::uint32_t e : {arc.begin.edge, arc.end.edge})
      if (e != q_edge_) nearest2 = std::min(nearest2, beyond2_[e].middle());
  return std::sqrt(std::max(nearest2, 0.0));
}

void CertifiedIntegrator::integrate(const Ball& t0, const Ball& t1, double relative) {
  const Ball whole = t1 - t0;
  work_.assign(1, {t0, t1, 0});
  // Intervals are processed in order of creation, so that all intervals left at the work limit are small.
  std::size_t halved = 0;
  const std::size_t limit = tabulated_ ? most_slab_halvings_with_table : most_slab_halvings;
  for (std::size_t next = 0; next < work_.size(); ++next) {
    stop_if_wanted();
    const Interval interval = work_[next];
    const bool fits =
        weighed_ ? try_patterned(interval, whole, relative) : try_interval(interval, whole, relative);
    if (fits) continue;
    if (++halved > limit || interval.depth >= deepest) {
      enclose(interval);
      ++given_up_;
      continue;
    }
    halve(interval);
  }
}

void CertifiedIntegrator::halve(const Interval& interval) {
  Interval first = interval, second = interval;
  first.depth = second.depth = interval.depth + 1;
  if (weighed_ && split_arcs_)
    first.v_to = second.v_from = (interval.v_from + interval.v_to) / 2;
  else
    first.to = second.from = ((interval.from + interval.to) / Ball(2)).centre();
  work_.push_back(std::move(first));
  work_.push_back(std::move(second));
}

/// Encloses an interval from zero to the full circle times the largest value of the integrand. If the area
/// times the range of the integrand is narrower, uses that instead.
void CertifiedIntegrator::enclose(const Interval& interval) {
  const Ball width = interval.to - interval.from, share((interval.v_to - interval.v_from) / 2);
  const Ball t(std::max(interval.to.hi(), 0.0)), r(root(q2_ + squared(interval.from)).lo());
  const Ball farthest = root(q2_ + squared(interval.to)), over = Ball::between(r.lo(), farthest.hi());
  const Ball radial_most = t * most_density(r, over);
  const Ball largest = radial_most * Ball(2) * Ball::pi() * width * share * largest_gain_;
  const double most = std::max(largest.hi(), 0.0);
  const std::vector<Ball> range =
      weighed_ && !(arcs_.empty() && !full_circle_) ? box(interval) : std::vector<Ball>(parts_.size());
  for (std::size_t b = 0; b < parts_.size(); ++b) {
    const bool narrower = weighed_ && range[b].is_finite() && range[b].hi() > 0 && range[b].hi() < most;
    parts_[b].sum += narrower ? Ball::between(std::max(range[b].lo(), 0.0), range[b].hi())
                              : Ball(most) * Ball::between(0, 1);
  }
}

bool CertifiedIntegrator::try_interval(const Interval& interval, const Ball& whole, double relative) {
  const Ball half = (interval.to - interval.from) / Ball(2), middle = interval.from + half;
  const double width = half.hi();
  if (!(width > 0)) return true;  // certainly empty
  const double typical = std::abs(value(middle).middle()) * 2 * width;
  const double share = whole.lo() > 0 ? std::min(1.0, 2 * width / whole.lo()) : 1;
  Part& part = parts_.front();
  const double allowed = relative * typical + part.allowed * share;

  double rho = largest_rho(middle.middle(), nearest_singularity(), width);
  for (int attempt = 0; attempt < 3 && rho > 1.3; ++attempt, rho = 1 + (rho - 1) / 3) {
    const double m = value(around(middle, half, rho)).largest();
    if (!(m < infinite)) continue;
    const int n = nodes_for(rho, std::log(m) + std::log(width), allowed);
    if (n > most_certified_nodes) continue;
    const CertifiedRule& rule = certified_rule(n);
    Ball sum = by_rule(middle, half, rule.node, rule.weight);
    sum.add_error(Ball(m) * half * exp(Ball(log_error(rho, n))));
    if (!sum.is_finite()) continue;
    part.sum += sum;
    return true;
  }
  return false;
}

}  // namespace tubefoot
