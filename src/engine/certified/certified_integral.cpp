// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_integral.hpp"

#include <algorithm>
#include <cmath>

#include "engine/certified/certified_scattering.hpp"
#include "engine/scattering/density.hpp"
#include "geometry/integrals/certified_rule.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/stop.hpp"

// Integrates certified polygons for one apex by Gauss-Legendre quadrature in ball arithmetic, slab by slab,
// with the error bound of L. N. Trefethen (Approximation Theory and Approximation Practice, theorem 19.3).
// See docs/notes/certified-energies.md, section "Error of the quadrature".
namespace tubefoot {
namespace {

constexpr std::size_t most_halvings = 500, most_halvings_with_table = 20000;  // per slab
constexpr int deepest = 90;

/// atan(height / s) for s > 0, by the formula that is not near a pole.
template <class N>
N turn_at(const Ball& height, const N& s, double size_of_s) {
  if (std::abs(height.middle()) <= size_of_s || height.may_be_zero()) return atan(N(height) / s);
  const N quarter = N(Ball::pi() / Ball(height.surely_positive() ? 2 : -2));
  return quarter - atan(s / N(height));
}

double size_of(const Ball& x) { return std::abs(x.middle()); }
double size_of(const ComplexBall& x) { return std::abs(x.real().middle()); }

}  // namespace

CertifiedIntegrator::CertifiedIntegrator(std::span<const double> borders_m, const Ball& beta_per_m)
    : borders_(borders_m), beta_(beta_per_m) {}

void CertifiedIntegrator::add(const CertifiedPolygon& polygon, std::uint32_t beam, const Allowance& allowance,
                              const Sink<Ball>& sink, const CertifiedCell* texture) {
  weighed_ = texture != nullptr;
  texture_ = texture;
  tabulated_ = false;
  largest_gain_ = Ball(1);
  if (texture != nullptr) {
    static const Directivity even;
    polygon_ = &polygon;
    transmit_.assign(1, cosine_of(even));
    receive_.assign(1, cosine_of(even));
    largest_gain_ = Ball(texture->texture->range().hi());
  }
  add(polygon, beam, beam + 1, allowance, sink);
}

void CertifiedIntegrator::add(const CertifiedPolygon& polygon, std::uint32_t first_beam,
                              std::uint32_t end_beam, const Allowance& allowance, const Sink<Ball>& sink) {
  if (polygon.edges.size() < 3) return;  // as thin as a line, even with this number of bits
  polygon_ = &polygon;
  distance2_ = squared(polygon.distance);
  slabs_.cut(polygon.ranges, polygon.foot, polygon.foot_inside, borders_);
  corners_.clear();
  for (const PolarSlabs::Slab& slab : slabs_.slabs()) {
    stop_if_wanted();
    parts_.resize(end_beam - first_beam);
    for (std::uint32_t beam = first_beam; beam < end_beam; ++beam)
      parts_[beam - first_beam] = {Ball(), allowance.absolute(beam, slab.sample)};
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
    const Ball area = (Ball(gap.hi) - Ball(gap.lo)) * angle * r;
    const Ball most = area * most_density(r, r) * largest_gain_;
    const Ball part = Ball(most.hi()) * Ball::between(0, 1);
    for (std::uint32_t sample = gap.first_sample; sample < gap.end_sample; ++sample)
      for (std::uint32_t beam = first_beam; beam < end_beam; ++beam) sink({beam, sample, part});
  };
  for (const PolarSlabs::Gap& gap : slabs_.gaps()) enclose_gap(gap);
  for (const PolarSlabs::Gap& gap : corners_) enclose_gap(gap);
}

/// A model is analytic in each of its pieces. The pieces meet at irrational ranges. Enclosures of these
/// ranges are omitted here and recorded in corners_.
void CertifiedIntegrator::integrate_slab(const PolarSlabs::Slab& slab, bool clear, double relative) {
  const auto part = [&](long double lo, long double hi) {
    if (!(hi > lo)) return;
    const Ball t0 = root(squared(Ball(lo)) - q2_), t1 = root(squared(Ball(hi)) - q2_);
    if (clear)
      integrate(t0, t1, relative);
    else
      enclose({t0, t1, 0});
  };
  model_piece_ = nullptr;
  if (model_ == nullptr) return part(slab.lo, slab.hi);
  const auto& pieces = model_->pieces();
  for (Part& p : parts_) p.allowed /= double(pieces.size());
  long double from = slab.lo;
  for (const ScatteringModel::Piece& piece : pieces) {
    model_piece_ = &piece;
    if (&piece == &pieces.back()) return part(from, slab.hi);
    Ball sine, cosine;
    sin_cos(Ball(piece.to), sine, cosine);
    const Ball corner = polygon_->distance / cosine;
    const long double lo = corner.fine_lo(), hi = corner.fine_hi();
    if (!(hi > from)) continue;
    part(from, std::min(lo, slab.hi));
    if (!(lo < slab.hi)) return;
    from = std::max(from, lo);
    corners_.push_back({from, std::min(hi, slab.hi), slab.sample, slab.sample + 1});
    if (!(hi < slab.hi)) return;
    from = hi;
  }
}

/// Cross-section over a ball of ranges, whatever pieces of the model they meet.
Ball CertifiedIntegrator::scattered_over(const Ball& r) const {
  return cross_section_over(*model_, atan2(root(squared(r) - distance2_), polygon_->distance),
                            polygon_->distance / r);
}

/// Upper bound of the density from `nearest` on, up to the far end of the ranges `over`.
Ball CertifiedIntegrator::most_density(const Ball& nearest, const Ball& over) const {
  const auto two_way = TwoWayRange<Ball>::of(nearest);
  if (model_ == nullptr) return lambert_density(two_way, beta_);
  return density(Ball(scattered_over(over).hi()), two_way, beta_);
}

/// Chooses q and pairs the arcs. Returns false if the pairs are not certain.
bool CertifiedIntegrator::prepare(std::span<const Crossing> crossings, const PolarSlabs::Slab& slab) {
  full_circle_ = crossings.empty();
  q2_ = distance2_;
  q_edge_ = std::uint32_t(polygon_->edges.size());
  arcs_.clear();
  if (full_circle_) return true;
  double largest = -1;
  for (const Crossing& c : crossings)
    if (const double n2 = polygon_->edges[c.edge].nearest2.middle(); n2 > largest) {
      largest = n2;
      q_edge_ = c.edge;
    }
  q2_ = polygon_->edges[q_edge_].nearest2;
  beyond2_.resize(polygon_->edges.size());
  for (const Crossing& c : crossings) beyond2_[c.edge] = q2_ - polygon_->edges[c.edge].nearest2;
  return find_arcs(crossings, root(squared(Ball(slab.lo + (slab.hi - slab.lo) / 2)) - q2_));
}

template <class N>
N CertifiedIntegrator::angle_at(const Crossing& crossing, const N& t, const N& t2) const {
  const CertifiedPolygon::Edge& edge = polygon_->edges[crossing.edge];
  const N s = crossing.edge == q_edge_ ? t : root(t2 + N(beyond2_[crossing.edge]));
  const N turn = turn_at(edge.height, s, size_of(s));
  return crossing.rising ? N(edge.angle) - turn : N(edge.angle + Ball::pi()) + turn;
}

/// Pairs each point where the polygon begins with the next point where it ends, on a circle in the middle of
/// a slab. The pairs hold in the whole slab.
bool CertifiedIntegrator::find_arcs(std::span<const Crossing> crossings, const Ball& t) {
  const Ball t2 = squared(t), two_pi = Ball(2) * Ball::pi();
  std::vector<std::pair<Ball, Crossing>> sorted;
  std::size_t rising = 0;
  for (const Crossing& c : crossings) {
    const Ball angle = angle_at(c, t, t2);
    if (!angle.is_finite()) return false;
    sorted.emplace_back(angle - two_pi * Ball(std::floor(angle.middle() / 6.283185307179586)), c);
    rising += c.rising;
  }
  if (2 * rising != sorted.size()) return false;
  std::sort(sorted.begin(), sorted.end(),
            [](const auto& a, const auto& b) { return a.first.middle() < b.first.middle(); });
  // With a single arc no confusion is possible. Otherwise the order must be certain.
  if (sorted.size() > 2)
    for (std::size_t k = 0; k + 1 < sorted.size(); ++k)
      if (!(sorted[k + 1].first - sorted[k].first).surely_positive() ||
          sorted[k].second.rising == sorted[k + 1].second.rising)
        return false;
  if (sorted.size() > 2 && !(sorted.front().first + two_pi - sorted.back().first).surely_positive())
    return false;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (!sorted[i].second.rising) continue;
    const Crossing begin = sorted[i].second, end = sorted[(i + 1) % sorted.size()].second;
    const Ball length = angle_at(end, t, t2) - angle_at(begin, t, t2);
    const double least = polygon_->foot_inside ? 0 : -1.5;
    const double turns = -std::floor((length.middle() - least) / 6.283185307179586);
    const Ball arc = length + two_pi * Ball(turns);
    // About a foot point outside of the polygon, an arc is at most half a circle, so a thin arc cannot be a
    // whole turn. About a foot point inside, the arc must certainly be neither empty nor a whole turn.
    if (polygon_->foot_inside && !(arc.surely_positive() && (two_pi - arc).surely_positive())) return false;
    arcs_.push_back({begin, end, two_pi * Ball(turns)});
  }
  return true;
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

/// t times the density, because the integral over t then equals the integral of density times r over r.
template <class N>
N CertifiedIntegrator::radial(const N& t, const N& r) const {
  const auto two_way = TwoWayRange<N>::of(r);
  const N beta(beta_);
  if (model_piece_ == nullptr) return t * lambert_density(two_way, beta);
  const N rho = full_circle_ ? t : root(N(q2_ - distance2_) + squared(t));
  const N incidence = N(Ball::pi() / Ball(2)) - turn_at(polygon_->distance, rho, size_of(rho));
  return t * density(cross_section_in(*model_piece_, incidence, N(N(polygon_->distance) / r)), two_way, beta);
}

template <class N>
N CertifiedIntegrator::arcs_length(const N& t, const N& t2) const {
  if (full_circle_) return N(Ball(2) * Ball::pi());
  N sum;
  for (const Arc& arc : arcs_) sum += angle_at(arc.end, t, t2) - angle_at(arc.begin, t, t2) + N(arc.turns);
  return sum;
}

void CertifiedIntegrator::integrate(const Ball& t0, const Ball& t1, double relative) {
  const Ball whole = t1 - t0;
  work_.assign(1, {t0, t1, 0});
  // Intervals are processed in order of creation, so that all intervals left at the work limit are small.
  std::size_t halved = 0;
  const std::size_t limit = tabulated_ ? most_halvings_with_table : most_halvings;
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
  const auto value = [&](const auto& t) {
    const auto t2 = squared(t);
    const auto r = root(decltype(t2)(q2_) + t2);
    return radial(t, r) * arcs_length(t, t2);
  };
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
    Ball sum;
    for (int i = 0; i < n; ++i) sum += rule.weight[i] * value(middle + half * rule.node[i]);
    sum = sum * half;
    sum.add_error(Ball(m) * half * exp(Ball(log_error(rho, n))));
    if (!sum.is_finite()) continue;
    part.sum += sum;
    return true;
  }
  return false;
}

// Instantiations for the code with patterns.
template Ball CertifiedIntegrator::angle_at(const Crossing&, const Ball&, const Ball&) const;
template ComplexBall CertifiedIntegrator::angle_at(const Crossing&, const ComplexBall&,
                                                   const ComplexBall&) const;
template Ball CertifiedIntegrator::radial(const Ball&, const Ball&) const;
template ComplexBall CertifiedIntegrator::radial(const ComplexBall&, const ComplexBall&) const;

}  // namespace tubefoot
