// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified_integral.hpp"

#include <arb_hypgeom.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tubefoot {
namespace {

constexpr int fewest_nodes = 2, most_nodes = 32;
constexpr std::size_t most_halvings = 500;  // of a slab
constexpr int deepest = 90;
constexpr double infinite = std::numeric_limits<double>::infinity();

struct CertifiedRule {
  std::vector<Ball> node, weight;
};

const CertifiedRule& certified_rule(int nodes) {
  static const std::array<CertifiedRule, most_nodes + 1> rules = [] {
    std::array<CertifiedRule, most_nodes + 1> all;
    for (int n = fewest_nodes; n <= most_nodes; ++n)
      for (int k = 0; k < n; ++k) {
        Ball node, weight;
        arb_hypgeom_legendre_p_ui_root(node.get(), weight.get(), ulong(n), ulong(k), ball_bits + 32);
        all[n].node.push_back(node);
        all[n].weight.push_back(weight);
      }
    return all;
  }();
  return rules[nodes];
}

/// Upper bound of the rule's error on [-1, 1] over M, in logarithms; doubles with a margin far beyond their
/// rounding.
double log_error(double rho, int nodes) {
  return std::log(64.0 / 15) - 2 * nodes * std::log(rho) - std::log1p(-1 / (rho * rho)) + 1e-9;
}

/// Nodes that bring the error, M times it, below `allowed`; more than most_nodes if there are none.
int nodes_for(double rho, double log_m, double allowed) {
  if (!(allowed > 0)) return most_nodes + 1;
  const double excess = log_m - std::log(allowed) + log_error(rho, 0);
  const double n = std::ceil(excess / (2 * std::log(rho)));
  return n > most_nodes ? most_nodes + 1 : std::max(fewest_nodes, int(n));
}

/// The rectangle around the ellipse of parameter rho about the interval [middle - half, middle + half].
ComplexBall around(const Ball& middle, const Ball& half, double rho) {
  const Ball a = half * Ball((rho + 1 / rho) / 2 * (1 + 1e-12)),
             b = half * Ball((rho - 1 / rho) / 2 * (1 + 1e-12));
  return {middle + a * Ball::between(-1, 1), b * Ball::between(-1, 1)};
}

double ellipse_through(double along, double across, double half) {
  const double a = std::hypot((along - half) / half, across / half);
  const double b = std::hypot((along + half) / half, across / half);
  const double sum = (a + b) / 2;
  return sum + std::sqrt(std::max(sum * sum - 1, 0.0));
}

/// The ellipse to try first, for a singularity at i `across` from t = 0. The rectangle around it must keep
/// away from the singularity and its square from the negative axis; a larger one than 64 saves no node.
double largest_rho(double along, double across, double half) {
  return std::min(1 + 0.4 * (ellipse_through(along, across, half) - 1), 64.0);
}

/// atan(height / s) for s > 0, whichever way is not near a pole.
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
                              const Sink& sink) {
  patterns_ = nullptr;
  largest_gain_ = Ball(1);
  add(polygon, beam, beam + 1, allowance, sink);
}

void CertifiedIntegrator::add(const CertifiedPolygon& polygon, std::uint32_t first_beam,
                              std::uint32_t end_beam, const Allowance& allowance, const Sink& sink) {
  if (polygon.edges.size() < 3) return;  // as thin as a line, even to these bits
  polygon_ = &polygon;
  distance2_ = squared(polygon.distance);
  slabs_.cut(polygon.ranges, polygon.foot, polygon.foot_inside, borders_);
  for (const PolarSlabs::Slab& slab : slabs_.slabs()) {
    parts_.resize(end_beam - first_beam);
    for (std::uint32_t beam = first_beam; beam < end_beam; ++beam)
      parts_[beam - first_beam] = {Ball(), allowance.absolute(beam, slab.sample)};
    const bool clear = prepare(slabs_.crossings(slab), slab);
    const Ball t0 = root(squared(Ball(slab.lo)) - q2_), t1 = root(squared(Ball(slab.hi)) - q2_);
    if (clear)
      integrate(t0, t1, allowance.relative);
    else
      enclose({t0, t1, 0});
    for (std::uint32_t beam = first_beam; beam < end_beam; ++beam)
      sink(beam, slab.sample, parts_[beam - first_beam].sum);
  }
  for (const PolarSlabs::Gap& gap : slabs_.gaps()) {
    // g(r) times the area between the two circles. The arcs of a circle in a convex polygon are no longer
    // than its perimeter: they are a part of the boundary of what both have in common.
    const Ball r = Ball::between(double(gap.lo) * (1 - 1e-15), double(gap.hi) * (1 + 1e-15)),
               rho = root(squared(r) - distance2_);
    const double turn = 2 * Ball::pi().hi(), by_perimeter = (polygon.perimeter / rho).hi();
    const Ball angle(by_perimeter < turn ? by_perimeter : turn);  // also where it is not a number
    const Ball most =
        (Ball(gap.hi) - Ball(gap.lo)) * angle * exp(-(beta_ * r)) / (r * squared(squared(r))) * largest_gain_;
    const Ball part = Ball(most.hi()) * Ball::between(0, 1);
    for (std::uint32_t sample = gap.first_sample; sample < gap.end_sample; ++sample)
      for (std::uint32_t beam = first_beam; beam < end_beam; ++beam) sink(beam, sample, part);
  }
}

/// Chooses q and pairs the arcs; false if that is not certain.
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

/// Pairs each place where the polygon begins with the next one where it ends, in the middle of a slab; the
/// pairs hold in all of it.
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
  // With one arc there is nothing to mix up, else the order has to be certain.
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
    // About a foot point outside an arc is at most half a circle, so a thin one cannot be mistaken for a
    // whole turn. About one inside it can: then it must be surely neither.
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

/// t g(r), so that its integral over t is that of g(r) r over r.
template <class N>
N CertifiedIntegrator::radial(const N& t, const N& r) const {
  return t * exp(-(N(beta_) * r)) / squared(r * squared(r));
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
  // First come, first served: what is left at the work limit is all small.
  std::size_t halved = 0;
  for (std::size_t next = 0; next < work_.size(); ++next) {
    const Interval interval = work_[next];
    const bool fits =
        patterns_ ? try_patterned(interval, whole, relative) : try_interval(interval, whole, relative);
    if (fits) continue;
    if (++halved > most_halvings || interval.depth >= deepest) {
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
  if (patterns_ && split_arcs_)
    first.v_to = second.v_from = (interval.v_from + interval.v_to) / 2;
  else
    first.to = second.from = ((interval.from + interval.to) / Ball(2)).centre();
  work_.push_back(std::move(first));
  work_.push_back(std::move(second));
}

/// From nothing to all of the circle times the integrand's largest value; or, if that says more, the area
/// times the integrand's range.
void CertifiedIntegrator::enclose(const Interval& interval) {
  const Ball width = interval.to - interval.from, share((interval.v_to - interval.v_from) / 2);
  const Ball t(std::max(interval.to.hi(), 0.0)), r(root(q2_ + squared(interval.from)).lo());
  const Ball largest = radial(t, r) * Ball(2) * Ball::pi() * width * share * largest_gain_;
  const double most = std::max(largest.hi(), 0.0);
  const std::vector<Ball> range =
      patterns_ && !(arcs_.empty() && !full_circle_) ? box(interval) : std::vector<Ball>(parts_.size());
  for (std::size_t b = 0; b < parts_.size(); ++b) {
    const bool narrower = patterns_ && range[b].is_finite() && range[b].hi() > 0 && range[b].hi() < most;
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
  if (!(width > 0)) return true;  // nothing, and surely so
  const double typical = std::abs(value(middle).middle()) * 2 * width;
  const double share = whole.lo() > 0 ? std::min(1.0, 2 * width / whole.lo()) : 1;
  Part& part = parts_.front();
  const double allowed = relative * typical + part.allowed * share;

  double rho = largest_rho(middle.middle(), nearest_singularity(), width);
  for (int attempt = 0; attempt < 3 && rho > 1.3; ++attempt, rho = 1 + (rho - 1) / 3) {
    const double m = value(around(middle, half, rho)).largest();
    if (!(m < infinite)) continue;
    const int n = nodes_for(rho, std::log(m) + std::log(width), allowed);
    if (n > most_nodes) continue;
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

// --- with patterns

void CertifiedIntegrator::add(const CertifiedPolygon& polygon, const BeamPatterns& patterns,
                              std::uint32_t tube, const Allowance& allowance, const Sink& sink) {
  const auto [first_beam, end_beam] = patterns.beams_of_tube[tube];
  if (first_beam == end_beam) return;
  polygon_ = &polygon;
  patterns_ = &patterns;
  transmit_.clear();
  receive_.clear();
  const auto look_at = [&](const Directivity& pattern) {
    double most = 0;
    if (pattern.table)
      for (const auto& segment : pattern.table->segments()) most = std::max(most, segment.c[0]);
    return most;
  };
  // A little above, for the rounding of the tables' cubics.
  const auto from_db = [](double db) {
    return exp(Ball(db * (1 + 1e-9) + 1e-9) * log(Ball(10)) / Ball(10));
  };
  Ball sent;
  for (const Directivity& beam : patterns.transmit[patterns.fan_of_tube[tube]].beams) {
    transmit_.push_back(cosine_of(beam));
    sent += from_db(look_at(beam));
  }
  double receive_db = 0;
  for (std::uint32_t beam = first_beam; beam < end_beam; ++beam) {
    receive_.push_back(cosine_of(patterns.receive[beam]));
    receive_db = std::max(receive_db, look_at(patterns.receive[beam]));
  }
  largest_gain_ = sent * from_db(receive_db);
  add(polygon, first_beam, end_beam, allowance, sink);
}

CertifiedIntegrator::Cosine CertifiedIntegrator::cosine_of(const Directivity& pattern) const {
  Cosine cosine;
  cosine.pattern = &pattern;
  const auto along = [&](const std::array<Ball, 3>& e) {
    return Ball(pattern.axis.x) * e[0] + Ball(pattern.axis.y) * e[1] + Ball(pattern.axis.z) * e[2];
  };
  cosine.away = along(polygon_->away);
  cosine.u = along(polygon_->u);
  cosine.v = along(polygon_->v);
  const Ball centre(pattern.centre);
  if (!pattern.from_axis) cosine.centre_angle = atan2(centre, root(Ball(1) - squared(centre)));
  return cosine;
}

template <class N>
N CertifiedIntegrator::cosine_at(const Cosine& c, const N& distance_over_r, const N& rho_over_r,
                                 const N& angle) const {
  N sine, cosine;
  sin_cos(angle, sine, cosine);
  return N(c.away) * distance_over_r + rho_over_r * (N(c.u) * cosine + N(c.v) * sine);
}

/// Upper bound of log |pattern| over a rectangle of cosines; infinite where the pattern is not analytic.
/// |sinc z| <= e^(pi |Im z|) and |2 J1(z) / z| <= e^|Im z|, because both are means of e^(i z s) over s;
/// |e^(-c a^2)| <= e^(c (Im a)^2). For a = asin w and for a = acos w, cosh(Im a) = (|w + 1| + |w - 1|) / 2.
double CertifiedIntegrator::log_bound(const Cosine& cosine, const ComplexBall& w) const {
  const Directivity& d = *cosine.pattern;
  if (d.kind == Directivity::Kind::uniform) return 0;
  if (!w.is_finite()) return infinite;
  const auto reach = [](const Ball& x) { return std::max(std::abs(x.lo()), std::abs(x.hi())); };
  constexpr double up = 1 + 1e-9;  // far above the rounding of the doubles below
  if (d.kind == Directivity::Kind::line) return d.growth(reach(w.imaginary())) * up;
  if (d.kind == Directivity::Kind::piston) {
    const ComplexBall u = ComplexBall(1.0) - squared(w);
    // (Im sqrt u)^2 = (|u| - Re u) / 2
    return 2 * d.size * std::sqrt(std::max(u.largest() - u.real().lo(), 0.0) / 2 * up) * up;
  }
  if (!(w.real().lo() > -1 && (d.from_axis || w.real().hi() < 1))) return infinite;
  const double stretch = ((w + ComplexBall(1.0)).largest() + (w - ComplexBall(1.0)).largest()) / 2 * up;
  const double y = std::acosh(std::max(stretch, 1.0)) * up;
  if (d.kind == Directivity::Kind::gaussian) return d.growth(y) * up;
  // A table: within one segment, a cubic of the angle.
  if (!(w.real().hi() < 1)) return infinite;
  ComplexBall angle;
  if (d.from_axis)
    acb_acos(angle.get(), w.get(), ball_bits);
  else
    acb_asin(angle.get(), w.get(), ball_bits);
  if (!d.from_axis) angle = angle - ComplexBall(cosine.centre_angle);
  const std::size_t segment = d.table->segment_at(angle.real().lo());
  if (segment != d.table->segment_at(angle.real().hi())) return infinite;
  const PatternTable::Segment& s = d.table->segments()[segment];
  const ComplexBall x = angle - ComplexBall(s.from);
  const ComplexBall level =
      ComplexBall(s.c[0]) + x * (ComplexBall(s.c[1]) + x * (ComplexBall(s.c[2]) + x * ComplexBall(s.c[3])));
  return level.real().hi() * 0.2302585092994046 + std::abs(level.real().hi()) * 1e-12;
}

Ball CertifiedIntegrator::gain(const Cosine& cosine, const Ball& w) const {
  const Directivity& d = *cosine.pattern;
  const Ball size(d.size);
  switch (d.kind) {
    case Directivity::Kind::uniform:
      return Ball(1);
    case Directivity::Kind::line: {
      Ball sinc;
      const Ball u = size * (w - Ball(d.centre));
      arb_sinc_pi(sinc.get(), u.get(), ball_bits);
      return squared(sinc);
    }
    case Directivity::Kind::piston: {
      // 2 J1(x) / x = 0F1(2; -x^2 / 4)
      Ball amplitude;
      const Ball z = squared(size) * (squared(w) - Ball(1)) / Ball(4), two(2);
      arb_hypgeom_0f1(amplitude.get(), two.get(), z.get(), 0, ball_bits);
      return squared(amplitude);
    }
    case Directivity::Kind::gaussian:
    case Directivity::Kind::table:
      break;
  }
  const Ball sine = root(Ball(1) - squared(w));
  const Ball angle = d.from_axis ? atan2(sine, w) : atan2(w, sine) - cosine.centre_angle;
  if (d.kind == Directivity::Kind::gaussian) return exp(-(Ball(4) * log(Ball(2)) * squared(angle / size)));
  if (!angle.is_finite()) return largest_gain_ * Ball::between(0, 1);
  Ball level;
  const std::size_t first = d.table->segment_at(angle.lo()), last = d.table->segment_at(angle.hi());
  for (std::size_t k = first; k <= last; ++k) {
    const PatternTable::Segment& s = d.table->segments()[k];
    const Ball x = angle - Ball(s.from);
    const Ball own = Ball(s.c[0]) + x * (Ball(s.c[1]) + x * (Ball(s.c[2]) + x * Ball(s.c[3])));
    if (k == first)
      level = own;
    else
      arb_union(level.get(), level.get(), own.get(), ball_bits);
  }
  return exp(level * log(Ball(10)) / Ball(10));
}

/// Middle and half length of an arc; without one, of the full circle.
template <class N>
std::pair<N, N> CertifiedIntegrator::ends_of(const Arc* arc, const N& t, const N& t2) const {
  if (arc == nullptr) return {N(), N(Ball::pi())};
  const N begin = angle_at(arc->begin, t, t2), end = angle_at(arc->end, t, t2) + N(arc->turns);
  return {(begin + end) * N(0.5), (end - begin) * N(0.5)};
}

/// Bounds of log |integrand| by beam over t times v, and their largest.
double CertifiedIntegrator::log_bound(const Arc* arc, const ComplexBall& t, const ComplexBall& v,
                                      std::vector<double>& by_beam) const {
  const ComplexBall t2 = squared(t), r = root(ComplexBall(q2_) + t2);
  const ComplexBall rho = root(ComplexBall(q2_ - distance2_) + t2) / r,
                    down = ComplexBall(polygon_->distance) / r;
  const auto [middle, half] = ends_of(arc, t, t2);
  const ComplexBall angle = middle + half * v;
  const double geometry = std::log((radial(t, r) * half).largest());
  const auto bound = [&](const Cosine& cosine) {
    if (cosine.pattern->kind == Directivity::Kind::uniform) return 0.0;
    return log_bound(cosine, cosine_at(cosine, down, rho, angle));
  };
  by_beam.assign(parts_.size(), infinite);
  // The logarithm of a sum, from its largest term.
  std::vector<double> sent_by_beam;
  for (const Cosine& beam : transmit_) sent_by_beam.push_back(bound(beam));
  const double strongest = *std::max_element(sent_by_beam.begin(), sent_by_beam.end());
  double sum = 0;
  for (const double beam : sent_by_beam) sum += std::exp(beam - strongest);
  const double sent = geometry + strongest + std::log(sum) + 1e-9;
  double largest = -infinite;
  for (std::size_t b = 0; b < by_beam.size(); ++b) {
    const double all = sent + bound(receive_[b]);
    by_beam[b] = all < infinite ? all : infinite;  // also where it is not a number
    largest = std::max(largest, by_beam[b]);
  }
  return largest;
}

/// By beam: the sum over an arc's nodes v of weight times integrand.
std::vector<Ball> CertifiedIntegrator::values(const Arc* arc, const Ball& t, const std::vector<Ball>& v,
                                              const std::vector<Ball>& weight) const {
  const Ball t2 = squared(t), r = root(q2_ + t2), rho = root(q2_ - distance2_ + t2) / r;
  const Ball down = polygon_->distance / r;
  const auto [middle, half] = ends_of(arc, t, t2);
  const Ball factor = radial(t, r) * half;
  std::vector<Ball> sums(parts_.size());
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Ball angle = middle + half * v[i];
    Ball sent;
    for (const Cosine& beam : transmit_) sent += gain(beam, cosine_at(beam, down, rho, angle));
    sent = factor * weight[i] * sent;
    for (std::size_t b = 0; b < sums.size(); ++b) {
      if (receive_[b].pattern->kind == Directivity::Kind::uniform)
        sums[b] += sent;
      else
        sums[b] += sent * gain(receive_[b], cosine_at(receive_[b], down, rho, angle));
    }
  }
  return sums;
}

bool CertifiedIntegrator::try_patterned(const Interval& interval, const Ball& whole, double relative) {
  const Ball half = (interval.to - interval.from) / Ball(2), middle = interval.from + half;
  const double width = half.hi(), v_half = (interval.v_to - interval.v_from) / 2;
  const double v_middle = interval.v_from + v_half;
  if (!(width > 0)) return true;
  const double share = (whole.lo() > 0 ? std::min(1.0, 2 * width / whole.lo()) : 1) * v_half;
  std::vector<const Arc*> arcs;
  for (const Arc& arc : arcs_) arcs.push_back(&arc);
  if (full_circle_) arcs.push_back(nullptr);

  // What each beam is allowed for each arc.
  std::vector<std::vector<double>> allowed(arcs.size());
  for (std::size_t a = 0; a < arcs.size(); ++a) {
    const std::vector<Ball> typical = values(arcs[a], middle, {Ball(v_middle)}, {Ball(2 * v_half)});
    for (std::size_t b = 0; b < parts_.size(); ++b)
      allowed[a].push_back(
          (relative * std::abs(typical[b].middle()) * 2 * width + parts_[b].allowed * share) /
          (2.0 * double(arcs.size())));
  }
  const ComplexBall all_v(Ball(v_middle) + Ball(v_half) * Ball::between(-1, 1));
  const Ball all_t = middle + half * Ball::between(-1, 1);
  std::vector<double> bounds;
  std::vector<double> error(parts_.size(), 0);
  std::vector<Ball> found(parts_.size());
  const double singular = nearest_singularity();
  for (std::size_t a = 0; a < arcs.size(); ++a) {
    // The fewest nodes over a few ellipses, for t and for v.
    struct Choice {
      int nodes = most_nodes + 1;
      double rho = 0;
      std::vector<double> log_m;
    };
    const auto choose = [&](double largest_rho, const std::function<double(double)>& evaluate) {
      Choice best;
      for (double rho = largest_rho; rho > 1.2; rho = 1 + (rho - 1) / 3) {
        if (!(evaluate(rho) < infinite)) continue;
        int n = fewest_nodes;
        for (std::size_t b = 0; b < bounds.size(); ++b)
          n = std::max(n, nodes_for(rho, bounds[b] + std::log(2 * width * v_half), allowed[a][b]));
        if (n < best.nodes)
          best = {n, rho, bounds};
        else if (best.nodes <= most_nodes)
          break;
      }
      return best;
    };
    const double rho_t = largest_rho(middle.middle(), singular, width);
    const Choice in_t = choose(
        rho_t, [&](double rho) { return log_bound(arcs[a], around(middle, half, rho), all_v, bounds); });
    const Choice in_v = choose(64, [&](double rho) {
      return log_bound(arcs[a], ComplexBall(all_t), around(Ball(v_middle), Ball(v_half), rho), bounds);
    });
    if (in_t.nodes > most_nodes || in_v.nodes > most_nodes) {
      split_arcs_ = in_v.nodes > most_nodes && (in_t.nodes <= most_nodes || interval.depth % 2 == 0);
      return try_box(interval, share, relative);
    }
    const CertifiedRule &rule_t = certified_rule(in_t.nodes), &rule_v = certified_rule(in_v.nodes);
    std::vector<Ball> v, weight;
    for (int i = 0; i < in_v.nodes; ++i) {
      v.push_back(Ball(v_middle) + Ball(v_half) * rule_v.node[i]);
      weight.push_back(Ball(v_half) * rule_v.weight[i]);
    }
    for (int k = 0; k < in_t.nodes; ++k) {
      const std::vector<Ball> row = values(arcs[a], middle + half * rule_t.node[k], v, weight);
      for (std::size_t b = 0; b < parts_.size(); ++b) found[b] += row[b] * rule_t.weight[k] * half;
    }
    // The rule in t errs for every v, the rule in v for every t; weights are positive and add up.
    for (std::size_t b = 0; b < parts_.size(); ++b)
      for (const Choice* c : {&in_t, &in_v})
        found[b].add_error(Ball(2 * v_half) * half * exp(Ball(c->log_m[b] + log_error(c->rho, c->nodes))));
  }
  for (std::size_t b = 0; b < parts_.size(); ++b)
    if (!found[b].is_finite()) return false;
  for (std::size_t b = 0; b < parts_.size(); ++b) parts_[b].sum += found[b];
  return true;
}

/// By beam: area times the integrand's range.
std::vector<Ball> CertifiedIntegrator::box(const Interval& interval) const {
  const Ball width = interval.to - interval.from;
  const Ball t = Ball::between(interval.from.lo(), interval.to.hi()),
             v = Ball::between(interval.v_from, interval.v_to);
  std::vector<Ball> found(parts_.size());
  const auto take = [&](const Arc* arc) {
    const std::vector<Ball> range = values(arc, t, {v}, {Ball(interval.v_to - interval.v_from)});
    for (std::size_t b = 0; b < found.size(); ++b) found[b] += range[b] * width;
  };
  for (const Arc& arc : arcs_) take(&arc);
  if (full_circle_) take(nullptr);
  return found;
}

/// A box that no rule serves, such as one across a row of a table, if it is narrow enough.
bool CertifiedIntegrator::try_box(const Interval& interval, double share, double relative) {
  const std::vector<Ball> found = box(interval);
  for (std::size_t b = 0; b < parts_.size(); ++b)
    if (!(found[b].hi() - found[b].lo() <= relative * found[b].lo() + parts_[b].allowed * share))
      return false;
  for (std::size_t b = 0; b < parts_.size(); ++b) parts_[b].sum += found[b];
  return true;
}

}  // namespace tubefoot
