// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/interval_integral.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/integrals/certified_rule.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/stop.hpp"

// Integrates polygons for one apex in intervals of doubles that are rounded outwards. The error bound of the
// quadrature uses bounds of the integrand on disks. See docs/notes/certified-energies.md, section "Doubles
// first".
namespace tubefoot {
namespace {

constexpr std::size_t most_interval_halvings = 60;  // per slab; ball arithmetic has a higher limit
/// Factors for bounds in doubles, for sums and products of non-negative numbers. They are far above
/// rounding.
constexpr double more = 1 + 1e-9, less = 1 - 1e-9;

/// Lower bound of the distance between a real t and the zeros of s^2 = t^2 + b.
double from_zeros(double t, const Interval& b) {
  return b.lo >= 0 ? std::sqrt(t * t + b.lo) * less : t * less - std::sqrt(-b.lo) * more;
}

}  // namespace

bool IntervalIntegrator::enclose(const IntervalPolygon& polygon, std::uint32_t beam,
                                 const Allowance& allowance, std::vector<SamplePart>& parts) {
  parts.clear();
  take_polygon(polygon);
  if (!(distance_.lo > 0) || !(beta_.lo >= 0)) return false;
  slabs_.cut(polygon.ranges, polygon.foot, polygon.foot_inside, borders_);
  corners_.clear();
  prepared_.reset();
  for (const PolarSlabs::Slab& slab : slabs_.slabs()) {
    stop_if_wanted();
    const Allowed allowed{allowance.relative, allowance.absolute(beam, slab.sample)};
    sum_ = Interval();
    if (!prepare_slab(slab) || !add_slab(slab, allowed)) return false;
    sum_.lo = std::max(sum_.lo, 0.0);  // all parts are non-negative
    // The factor allows a quarter more than the error of the rule, for rounding.
    if (!(sum_.width() / 2 <= 1.25 * (allowed.relative * sum_.lo + allowed.absolute))) return false;
    parts.push_back({slab.sample, sum_});
  }
  const auto enclose_gap = [&](const PolarSlabs::Gap& gap) {
    // Density times the area between the two circles, as in CertifiedIntegrator.
    const double area = double(gap.hi - gap.lo) * double(gap.hi) * most_turn(gap.lo),
                 most = area * most_density_over(FineInterval(gap.lo, gap.hi).in_doubles()) * more;
    for (std::uint32_t sample = gap.first_sample; sample < gap.end_sample; ++sample) {
      if (!(most <= allowance.absolute(beam, sample))) return false;
      parts.push_back({sample, {0, most}});
    }
    return true;
  };
  return std::all_of(slabs_.gaps().begin(), slabs_.gaps().end(), enclose_gap) &&
         std::all_of(corners_.begin(), corners_.end(), enclose_gap);
}

bool IntervalIntegrator::add_slab(const PolarSlabs::Slab& slab, const Allowed& allowed) {
  Allowed each = allowed;
  if (model_ != nullptr) each.absolute /= double(model_->pieces().size());
  return each_piece(slab, [&](long double lo, long double hi) { return add_ranges(lo, hi, each); });
}

/// Integrates between two values of t that are doubles and certainly within the ranges. The rest contributes
/// an interval from zero to its upper bound. Next to q, t is the root of a number close to zero. An
/// enclosure of t would be far wider than that of the area.
bool IntervalIntegrator::add_ranges(long double lo, long double hi, const Allowed& allowed) {
  if (!(hi > lo)) return true;
  const FineInterval t2_from = squared(FineInterval(lo)) - q2_, t2_to = squared(FineInterval(hi)) - q2_;
  const double from = root(t2_from).in_doubles().hi, to = root(t2_to).in_doubles().lo;
  const bool within = to > from;
  const FineInterval outside =
      within ? squared(FineInterval(from)) - t2_from + t2_to - squared(FineInterval(to)) : t2_to - t2_from;
  const double area = static_cast<double>(std::max(outside.hi, 0.0L)) / 2 * most_turn(lo),
               most = area * most_density_over(FineInterval(lo, hi).in_doubles()) * more;
  sum_ += Interval(0, most);
  return !within || integrate(from, to, allowed);
}

/// Upper bound of the total angle of all arcs at any range from this one on. The arcs of a circle in a
/// convex polygon are no longer than the polygon's perimeter.
double IntervalIntegrator::most_turn(long double range) const {
  const FineInterval rho = root(squared(FineInterval(range)) - squared(polygon_->distance));
  const double least = std::max(rho.in_doubles().lo, 0.0),  // rounded outwards, possibly below 0
      by_perimeter = polygon_->perimeter.in_doubles().hi / least * more;
  const double whole = IntervalNumbers::two_pi().hi;
  return by_perimeter < whole ? by_perimeter : whole;  // also if the value is not a number
}

double IntervalIntegrator::most_in(const Stretch& stretch) const {
  const Interval range = root(range_q2_ + squared(Interval(stretch.from, stretch.to)));
  const double area = (stretch.to - stretch.from) * stretch.to * most_turn(range.lo);
  return area * most_density_over(range) * more;
}

bool IntervalIntegrator::prepare_slab(const PolarSlabs::Slab& slab) {
  if (prepared_ == std::pair(slab.first, slab.count)) return true;
  prepared_ = {slab.first, slab.count};
  return prepare(slabs_.crossings(slab), slab);
}

bool IntervalIntegrator::integrate(double from, double to, const Allowed& allowed) {
  const double whole = to - from;
  work_.assign(1, {from, to});
  std::size_t halved = 0;
  for (std::size_t next = 0; next < work_.size(); ++next) {
    const Stretch stretch = work_[next];
    const double share = std::min((stretch.to - stretch.from) / whole, 1.0);
    if (try_rule(stretch, allowed, share)) continue;
    if (const double most = most_in(stretch); most <= allowed.absolute * share) {
      sum_ += Interval(0, most);
      continue;
    }
    const double middle = stretch.from + (stretch.to - stretch.from) / 2;
    if (++halved > most_interval_halvings || !(middle > stretch.from && middle < stretch.to)) return false;
    work_.push_back({stretch.from, middle});
    work_.push_back({middle, stretch.to});
  }
  return true;
}

IntervalIntegrator::Place IntervalIntegrator::place_at(double t, const Interval& arcs) {
  Place place;
  place.t = t;
  place.arcs = arcs.largest();
  const Interval t2 = squared(Interval(t));
  place.range = root(range_q2_ + t2);
  place.range_zeros = from_zeros(t, range_q2_);
  place.nearest_zeros = place.range_zeros;
  ends_.clear();
  if (model_piece_ != nullptr) place.incidence = angle_of(distance_, rho_at(Interval(t), t2));
  if (full_circle_) return place;
  place.rho_zeros = from_zeros(t, rho_q2_);
  place.nearest_zeros = std::min(place.nearest_zeros, place.rho_zeros);
  for (const PolarArcs::Arc& arc : arcs_)
    for (const std::uint32_t e : {arc.begin.edge, arc.end.edge}) {
      const double height = polygon_->edges[e].height.largest();
      if (e == q_edge_) {
        ends_.push_back({height, 0, true});
      } else {
        ends_.push_back({height, from_zeros(t, beyond2_[e]), false});
        place.nearest_zeros = std::min(place.nearest_zeros, ends_.back().from_zeros);
      }
    }
  return place;
}

/// Upper bound of the modulus of the integrand in the disk, which contains none of the zeros. A root s of
/// t^2 + b has a positive real part. Its modulus lies between the distance of its zeros minus the radius and
/// that distance plus the radius. The angle at an edge has the slope -height t / (s rho^2), with s = t for
/// the edge of q.
double IntervalIntegrator::most_within(const Place& place, double radius) const {
  const double top = place.t + radius, range = (place.range_zeros - radius) * less,
               rho = (place.rho_zeros - radius) * less;
  double arcs = place.arcs;
  for (const End& end : ends_) {
    const double slope = end.height / (rho * rho);
    arcs += radius * (end.of_q ? slope : slope * top / ((end.from_zeros - radius) * less));
  }
  // |r - r0| = |t - t0| |t + t0| / |r + r0|
  const double off = radius * (place.t + top) / place.range_zeros * more,
               nearest = std::max(place.range.lo * less - off, 0.0);
  const double absorbed = std::exp(-2 * beta_.lo * nearest), range2 = range * range, range4 = range2 * range2;
  const double scattered = model_piece_ == nullptr ? 1 / range2 : most_scattered(place, radius);
  const double most = top * absorbed * scattered / range4 * arcs * more;
  return most >= 0 ? most : infinite;  // also if the value is not a number
}

/// The same bound for the piece of the scattering model.
double IntervalIntegrator::most_scattered(const Place& place, double radius) const {
  const double range = (place.range_zeros - radius) * less;
  // The angle of incidence has the slope distance t / (r^2 rho).
  double off = radius * distance_.hi / (range * range) * more;
  if (!full_circle_) off *= (place.t + radius) / ((place.rho_zeros - radius) * less);
  const Interval sine(distance_.lo / (place.range.hi + radius) * less, distance_.hi / range * more);
  const Interval incidence(place.incidence.lo - off, place.incidence.hi + off);
  const Interval real_square = squared(incidence) - Interval(0, off * off * more);
  double sum = 0;
  for (const ScatteringModel::Term& t : model_piece_->terms)
    sum += t.level * power_of(sine, t.power).hi *
           exp(t.slope * (incidence - model_piece_->from) - t.curvature * real_square).hi;
  return sum * more;
}

bool IntervalIntegrator::try_rule(const Stretch& stretch, const Allowed& allowed, double share) {
  const Interval half = (Interval(stretch.to) - stretch.from) * 0.5, middle = stretch.from + half;
  // The distance of t from the true middle is less than the excess of `reach` over half the stretch.
  const double t = stretch.from + (stretch.to - stretch.from) / 2,
               reach = std::max(stretch.to - t, t - stretch.from) * more;
  const Interval t2 = squared(Interval(t)), arcs = arcs_length(Interval(t), t2);
  const Place place = place_at(t, arcs);
  const Interval r2 = range_q2_ + t2;
  const double typical = (radial(Interval(t), r2, root(r2)) * arcs).middle() * 2 * reach;
  const double error_allowed = allowed.relative * std::abs(typical) + allowed.absolute * share;

  int nodes = most_certified_nodes + 1;
  double rho = 0, most = 0;
  for (const double part : {0.5, 0.75, 0.3}) {
    const double radius = part * place.nearest_zeros, axis = radius / reach * less;
    if (!(axis > 1.05)) continue;
    const double own_rho = (axis + std::sqrt(axis * axis - 1)) * less, own_most = most_within(place, radius);
    if (!(own_most < infinite)) continue;
    const int n = nodes_for(own_rho, std::log(own_most) + std::log(reach), error_allowed);
    if (n < nodes) nodes = n, rho = own_rho, most = own_most;
    if (nodes <= 3) break;
  }
  if (nodes > most_certified_nodes) return false;
  const CertifiedRule& rule = certified_rule(nodes);
  Interval sum = by_rule(middle, half, rule.node_in_doubles, rule.weight_in_doubles);
  const double error = most * reach * std::exp(log_error(rho, nodes)) * more;
  sum = outwards(sum.lo - error, sum.hi + error);
  if (!sum.is_finite()) return false;
  sum_ += sum;
  return true;
}

}  // namespace tubefoot
