// SPDX-License-Identifier: GPL-3.0-or-later
// Implements CertifiedIntegrator with beam patterns or a micro-texture. Gauss-Legendre quadrature runs over t
// and along the arcs, with an error bound in the complex plane for each variable. See
// docs/notes/certified-energies.md, sections "Error of the quadrature" and "Micro-texture".
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "engine/certified/certified_integral.hpp"
#include "geometry/integrals/certified_rule.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {

void CertifiedIntegrator::add(const CertifiedPolygon& polygon, const BeamPatterns& patterns,
                              std::uint32_t tube, const Allowance& allowance, const Sink<Ball>& sink,
                              const CertifiedCell* texture) {
  const auto [first_beam, end_beam] = patterns.beams_of_tube[tube];
  if (first_beam == end_beam) return;
  weighed_ = true;
  texture_ = texture;
  transmit_.clear();
  receive_.clear();
  tabulated_ = false;
  Ball sent, received(1);
  for (const Directivity& beam : patterns.transmit[patterns.fan_of_tube[tube]].beams) {
    transmit_.push_back(cosine_of(beam, polygon));
    tabulated_ = tabulated_ || transmit_.back().is_table();
    sent += transmit_.back().largest();
  }
  for (std::uint32_t beam = first_beam; beam < end_beam; ++beam) {
    receive_.push_back(cosine_of(patterns.receive[beam], polygon));
    tabulated_ = tabulated_ || receive_.back().is_table();
    const Ball largest = receive_.back().largest();
    if (beam == first_beam || largest.hi() > received.hi()) received = largest;
  }
  largest_gain_ = sent * received;
  if (texture != nullptr) largest_gain_ = largest_gain_ * Ball(texture->texture->range().hi());
  add(polygon, first_beam, end_beam, allowance, sink);
}

CertifiedIntegrator::Cosine CertifiedIntegrator::cosine_of(const Directivity& pattern,
                                                           const CertifiedPolygon& polygon) {
  Cosine cosine{CertifiedGain(pattern), {}, {}, {}};
  const auto along = [&](const std::array<Ball, 3>& e) {
    return Ball(pattern.axis.x) * e[0] + Ball(pattern.axis.y) * e[1] + Ball(pattern.axis.z) * e[2];
  };
  cosine.away = along(polygon.away);
  cosine.u = along(polygon.u);
  cosine.v = along(polygon.v);
  return cosine;
}

template <class N>
N CertifiedIntegrator::cosine_at(const Cosine& c, const N& distance_over_r, const N& rho_over_r,
                                 const N& angle) const {
  N sine, cosine;
  sin_cos(angle, sine, cosine);
  return N(c.away) * distance_over_r + rho_over_r * (N(c.u) * cosine + N(c.v) * sine);
}

/// Calls take_segment() for all patterns over a part of an arc. Returns the errors by beam, for the product
/// of transmit and receive pattern.
std::vector<double> CertifiedIntegrator::take_segments(const Arc* arc, const Ball& t, const Ball& v) {
  const Ball t2 = squared(t), r = root(q2_ + t2), rho = root(q2_ - distance2_ + t2) / r;
  const Ball down = polygon_->distance / r;
  const auto [middle, half] = ends_of(arc, t, t2);
  const Ball angle = middle + half * v;
  const auto take = [&](Cosine& cosine) { return cosine.take_segment(cosine_at(cosine, down, rho, angle)); };
  double sent = 0;  // the relative error of a sum is at most that of one of its terms
  for (Cosine& beam : transmit_) sent = std::max(sent, take(beam));
  std::vector<double> off;
  for (Cosine& beam : receive_) off.push_back(sent + take(beam));
  return off;
}

/// Middle and half length of an arc, or of the full circle without an arc.
template <class N>
std::pair<N, N> CertifiedIntegrator::ends_of(const Arc* arc, const N& t, const N& t2) const {
  if (arc == nullptr) return {N(), N(Ball::pi())};
  const N begin = angle_at(arc->begin, t, t2), end = angle_at(arc->end, t, t2) + N(arc->constant);
  return {(begin + end) * N(0.5), (end - begin) * N(0.5)};
}

/// Bounds log |integrand| by beam over t times v. Returns the largest bound.
double CertifiedIntegrator::log_bound(const Arc* arc, const ComplexBall& t, const ComplexBall& v,
                                      std::vector<double>& by_beam) const {
  const ComplexBall t2 = squared(t), r2 = ComplexBall(q2_) + t2, r = root(r2);
  const ComplexBall rho = root(ComplexBall(q2_ - distance2_) + t2) / r,
                    down = ComplexBall(polygon_->distance) / r;
  const auto [middle, half] = ends_of(arc, t, t2);
  const ComplexBall angle = middle + half * v;
  double geometry = std::log((radial(t, r2, r) * half).largest());
  if (texture_ != nullptr) geometry += std::log(texture_->largest(rho * r, angle)) + 1e-9;
  const auto bound = [&](const Cosine& cosine) {
    if (cosine.is_uniform()) return 0.0;
    return cosine.log_bound(cosine_at(cosine, down, rho, angle));
  };
  by_beam.assign(parts_.size(), infinite);
  // The logarithm of a sum is computed from its largest term.
  std::vector<double> sent_by_beam;
  for (const Cosine& beam : transmit_) sent_by_beam.push_back(bound(beam));
  const double strongest = *std::max_element(sent_by_beam.begin(), sent_by_beam.end());
  double sum = 0;
  for (const double beam : sent_by_beam) sum += std::exp(beam - strongest);
  const double sent = geometry + strongest + std::log(sum) + 1e-9;
  double largest = -infinite;
  for (std::size_t b = 0; b < by_beam.size(); ++b) {
    const double all = sent + bound(receive_[b]);
    by_beam[b] = all < infinite ? all : infinite;  // also if the value is not a number
    largest = std::max(largest, by_beam[b]);
  }
  return largest;
}

/// Returns, by beam, the sum of weight times integrand over the nodes v of an arc.
std::vector<Ball> CertifiedIntegrator::values(const Arc* arc, const Ball& t, const std::vector<Ball>& v,
                                              const std::vector<Ball>& weight) const {
  const Ball t2 = squared(t), r2 = q2_ + t2, r = root(r2), rho = root(q2_ - distance2_ + t2) / r;
  const Ball down = polygon_->distance / r;
  const auto [middle, half] = ends_of(arc, t, t2);
  const Ball factor = radial(t, r2, r) * half;
  std::vector<Ball> sums(parts_.size());
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Ball angle = middle + half * v[i];
    Ball sent;
    for (const Cosine& beam : transmit_) sent += gain(beam, cosine_at(beam, down, rho, angle));
    sent = factor * weight[i] * sent;
    if (texture_ != nullptr) sent = sent * texture_->factor(rho * r, angle);
    for (std::size_t b = 0; b < sums.size(); ++b) {
      if (receive_[b].is_uniform())
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

  // Permitted error of each beam for each arc.
  std::vector<std::vector<double>> allowed(arcs.size()), typical_of(arcs.size());
  for (std::size_t a = 0; a < arcs.size(); ++a) {
    const std::vector<Ball> typical = values(arcs[a], middle, {Ball(v_middle)}, {Ball(2 * v_half)});
    for (std::size_t b = 0; b < parts_.size(); ++b) {
      typical_of[a].push_back(std::abs(typical[b].middle()) * 2 * width);
      allowed[a].push_back((relative * typical_of[a][b] + parts_[b].allowed * share) /
                           (2.0 * double(arcs.size())));
    }
  }
  const ComplexBall all_v(Ball(v_middle) + Ball(v_half) * Ball::between(-1, 1));
  const Ball all_t = middle + half * Ball::between(-1, 1);
  std::vector<double> bounds;
  std::vector<double> error(parts_.size(), 0);
  std::vector<Ball> found(parts_.size());
  const double singular = nearest_singularity();
  for (std::size_t a = 0; a < arcs.size(); ++a) {
    // Borders of a table are curves. The number of boxes of size h along them is 1 / h, and each box may
    // have this error.
    std::vector<double> off(parts_.size(), 0);
    if (tabulated_) {
      off = take_segments(arcs[a], all_t, all_v.real());
      for (std::size_t b = 0; b < parts_.size(); ++b)
        if (off[b] > 0 &&
            !(off[b] < 1 && std::expm1(off[b]) * typical_of[a][b] * std::sqrt(share) <= allowed[a][b])) {
          // Halves the direction in which the angles change more.
          const std::vector<double> by_t = take_segments(arcs[a], all_t, Ball(v_middle)),
                                    by_v = take_segments(arcs[a], middle, all_v.real());
          split_arcs_ = by_t[b] == by_v[b] ? interval.depth % 2 == 0 : by_v[b] > by_t[b];
          return try_box(interval, share, relative);
        }
    }
    by_segment_ = tabulated_;
    // Fewest nodes over a few ellipses, for t and for v.
    struct Choice {
      int nodes = most_certified_nodes + 1;
      double rho = 0;
      std::vector<double> log_m;
    };
    const auto choose = [&](double largest_rho, const std::function<double(double)>& evaluate) {
      Choice best;
      for (double rho = largest_rho; rho > 1.2; rho = 1 + (rho - 1) / 3) {
        if (!(evaluate(rho) < infinite)) continue;
        int n = fewest_certified_nodes;
        for (std::size_t b = 0; b < bounds.size(); ++b)
          n = std::max(n, nodes_for(rho, bounds[b] + std::log(2 * width * v_half), allowed[a][b]));
        if (n < best.nodes)
          best = {n, rho, bounds};
        else if (best.nodes <= most_certified_nodes)
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
    if (in_t.nodes > most_certified_nodes || in_v.nodes > most_certified_nodes) {
      by_segment_ = false;
      // Near a foot point on an edge, angles have no finite bound until t has been halved towards it.
      const bool near_foot = interval.to.hi() > 4 * interval.from.lo();
      split_arcs_ = in_v.nodes > most_certified_nodes &&
                    (in_t.nodes <= most_certified_nodes || (interval.depth % 2 == 0 && !near_foot));
      return try_box(interval, share, relative);
    }
    const CertifiedRule &rule_t = certified_rule(in_t.nodes), &rule_v = certified_rule(in_v.nodes);
    std::vector<Ball> v, weight;
    for (int i = 0; i < in_v.nodes; ++i) {
      v.push_back(Ball(v_middle) + Ball(v_half) * rule_v.node[i]);
      weight.push_back(Ball(v_half) * rule_v.weight[i]);
    }
    std::vector<Ball> own(parts_.size());
    for (int k = 0; k < in_t.nodes; ++k) {
      const std::vector<Ball> row = values(arcs[a], middle + half * rule_t.node[k], v, weight);
      for (std::size_t b = 0; b < parts_.size(); ++b) own[b] += row[b] * rule_t.weight[k] * half;
    }
    // The rule in t has its error for every v, and the rule in v for every t. Weights are positive and have
    // a fixed sum.
    for (std::size_t b = 0; b < parts_.size(); ++b)
      for (const Choice* c : {&in_t, &in_v})
        own[b].add_error(Ball(2 * v_half) * half * exp(Ball(c->log_m[b] + log_error(c->rho, c->nodes))));
    by_segment_ = false;
    for (std::size_t b = 0; b < parts_.size(); ++b) {
      // The integrand is positive, so the relative error of the integral is at most that of the integrand.
      const double most = std::max(std::abs(own[b].lo()), std::abs(own[b].hi()));
      if (off[b] > 0) own[b].add_error(Ball(most) * (exp(Ball(off[b])) - Ball(1)));
      found[b] += own[b];
    }
  }
  for (std::size_t b = 0; b < parts_.size(); ++b)
    if (!found[b].is_finite()) return false;
  for (std::size_t b = 0; b < parts_.size(); ++b) parts_[b].sum += found[b];
  return true;
}

/// Returns, by beam, the area times the range of the integrand.
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

/// Encloses a box for which no quadrature rule is suitable, such as a box across a border of a table.
/// Returns false if the enclosure is too wide.
bool CertifiedIntegrator::try_box(const Interval& interval, double share, double relative) {
  const std::vector<Ball> found = box(interval);
  for (std::size_t b = 0; b < parts_.size(); ++b)
    if (!(found[b].hi() - found[b].lo() <= relative * found[b].lo() + parts_[b].allowed * share))
      return false;
  for (std::size_t b = 0; b < parts_.size(); ++b) parts_[b].sum += found[b];
  return true;
}

}  // namespace tubefoot
