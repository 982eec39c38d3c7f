// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_path_energy.hpp"

#include <algorithm>
#include <cmath>

#include "engine/certified/certified_scattering.hpp"
#include "engine/scattering/density.hpp"
#include "geometry/numbers/complex_ranges.hpp"
#include "geometry/numbers/scalars.hpp"

// Encloses the bistatic density sigma(g_T, g_R) r_T^-2 r_R^-2 10^(-alpha (r_T + r_R) / 10) B_T B_R with
// mirror losses, in balls and intervals of doubles. Over complex positions it bounds the logarithm of the
// modulus with margins for rounding. See docs/notes/certified-energies.md, section "Two apexes".
namespace tubefoot {
namespace {

/// Returns whether a ball covers many positions, and not just one position with its rounding.
bool is_wide(const Ball& x) { return arb_rel_accuracy_bits(x.get()) < 20; }

/// Factors far above the rounding of doubles.
constexpr double up = 1 + 1e-12, down = 1 - 1e-12;

bool depends_on_angle(const ScatteringModel::Piece& piece) {
  return std::ranges::any_of(piece.terms, [](const ScatteringModel::Term& t) {
    return t.level != 0 && (t.slope != 0 || t.curvature != 0);
  });
}

/// Angle of at most 1 for whose imaginary part growth(y) is at most e^3.
template <class Growth>
double smooth_angle(const Growth& growth) {
  double angle = 1;
  while (growth(angle) > 3 && angle > 1e-6) angle /= 2;
  return angle;
}

}  // namespace

CertifiedEnd::CertifiedEnd(const CertifiedPolygon& polygon, const std::array<Ball, 3>& place_m)
    : u_(polygon.u), v_(polygon.v), over_(apex_over(polygon, place_m)) {
  for (std::size_t k = 0; k < 3; ++k) to_foot_[k] = polygon.away[k] * polygon.distance - place_m[k];
  take_doubles();
}

CertifiedEnd::CertifiedEnd(const ApexOverPlane& over, const LyingPlane& seen) : over_(over) {
  for (int k = 0; k < 3; ++k) {
    to_foot_[std::size_t(k)] = Ball(seen.foot_m[k]);
    u_[std::size_t(k)] = Ball(seen.u[k]);
    v_[std::size_t(k)] = Ball(seen.v[k]);
  }
  take_doubles();
}

void CertifiedEnd::take_doubles() {
  height_ = interval_of(over_.height);
  x_ = interval_of(over_.x);
  y_ = interval_of(over_.y);
}

CertifiedEnd::Trace CertifiedEnd::trace(const glm::dvec3& axis) const {
  const auto along = [&](const std::array<Ball, 3>& e) {
    return Ball(axis.x) * e[0] + Ball(axis.y) * e[1] + Ball(axis.z) * e[2];
  };
  return {along(to_foot_), along(u_), along(v_)};
}

Ball CertifiedEnd::range(const PlanePlace<Ball>& p) const {
  Ball r = root(squared(over_.height) + squared(p.x - over_.x) + squared(p.y - over_.y));
  // Balls of squares may reach below 0. For balls of many positions, this limit restores the height as the
  // least range.
  if (is_wide(r) && r.lo() < over_.height.lo()) r = Ball::between(over_.height.lo(), r.hi());
  return r;
}

Interval CertifiedEnd::range(const PlanePlace<Interval>& p) const {
  return root(squared(height_) + squared(p.x - x_) + squared(p.y - y_));
}

ComplexBall CertifiedEnd::range2(const PlanePlace<ComplexBall>& p) const {
  return ComplexBall(squared(over_.height)) + squared(p.x - ComplexBall(over_.x)) +
         squared(p.y - ComplexBall(over_.y));
}

void CertifiedEnd::take_loss(const MirrorLoss& loss) {
  loss_ = loss.none() ? nullptr : &loss;
  rough_.clear();
  rough_in_doubles_.clear();
  for (const glm::dvec3& normal : loss.rough_normals) {
    rough_.push_back(trace(normal));
    rough_in_doubles_.push_back(in_doubles(rough_.back()));
  }
}

Ball CertifiedEnd::cosine(const Trace& trace, const PlanePlace<Ball>& p, const Ball& range) {
  const Ball w = trace.at(p.x, p.y) / range;
  if (w.lo() >= -1 && w.hi() <= 1) return w;
  const auto in = [](double x, double otherwise) {  // no cosine is beyond this
    return std::isnan(x) ? otherwise : std::clamp(x, -1.0, 1.0);
  };
  return Ball::between(in(w.lo(), -1), in(w.hi(), 1));
}

Interval CertifiedEnd::cosine(const IntervalTrace& trace, const PlanePlace<Interval>& p,
                              const Interval& range) {
  const Interval w = trace.at(p.x, p.y) / range;
  return {std::clamp(w.lo, -1.0, 1.0), std::clamp(w.hi, -1.0, 1.0)};  // no cosine is beyond this
}

Ball CertifiedEnd::passed(const PlanePlace<Ball>& p, const Ball& range) const {
  if (loss_ == nullptr) return Ball(1);
  if (rough_.empty()) return Ball(loss_->factor);
  Ball exponent;
  for (const Trace& normal : rough_) {
    const Ball sine2 = squared(cosine(normal, p, range));
    exponent += loss_->bend == 0 ? sine2 : Ball(1) - Ball(1 + loss_->bend) * (Ball(1) - sine2);
  }
  if (exponent.lo() < 0) exponent = Ball::between(0, std::max(exponent.hi(), 0.0));
  return Ball(loss_->factor) * exp(-(Ball(loss_->roughness) * exponent));
}

Interval CertifiedEnd::passed(const PlanePlace<Interval>& p, const Interval& range) const {
  if (loss_ == nullptr) return 1;
  Interval exponent;
  for (const IntervalTrace& normal : rough_in_doubles_) {
    const Interval sine2 = squared(cosine(normal, p, range));
    exponent += loss_->bend == 0 ? sine2 : 1.0 - (Interval(1) + loss_->bend) * (Interval(1) - sine2);
  }
  exponent = {std::max(exponent.lo, 0.0), std::max(exponent.hi, 0.0)};
  return loss_->factor * exp(-(loss_->roughness * exponent));
}

Ball CertifiedEnd::incidence(const PlanePlace<Ball>& p) const {
  return atan2(root(squared(p.x - over_.x) + squared(p.y - over_.y)), over_.height);
}

Interval CertifiedEnd::incidence(const PlanePlace<Interval>& p) const {
  const Interval rho = root(squared(p.x - x_) + squared(p.y - y_));
  return outwards(std::atan2(rho.lo, height_.hi), std::atan2(rho.hi, height_.lo), library_units);
}

bool CertifiedEnd::take_piece(const ScatteringModel& model, const PlanePlace<Ball>& box) {
  const auto& pieces = model.pieces();
  piece_ = &pieces.front();
  if (pieces.size() == 1) return true;
  const Ball angle = incidence(box);
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const bool from = k == 0 || angle.lo() >= pieces[k].from,
               to = k + 1 == pieces.size() || angle.hi() <= pieces[k].to;
    if (!from || !to) continue;
    piece_ = &pieces[k];
    return true;
  }
  piece_ = nullptr;
  return false;
}

Ball CertifiedEnd::cross_section(const ScatteringModel& model, const PlanePlace<Ball>& p,
                                 const Ball& range) const {
  const Ball sine = over_.height / range;
  if (piece_ == nullptr) return cross_section_over(model, incidence(p), sine);
  return cross_section_in(*piece_, depends_on_angle(*piece_) ? incidence(p) : Ball(), sine);
}

Interval CertifiedEnd::cross_section(const ScatteringModel& model, const PlanePlace<Interval>& p,
                                     const Interval& range) const {
  const Interval sine = height_ / range, angle = incidence(p);
  return piece_ == nullptr ? cross_section_over(model, angle, sine) : cross_section_in(*piece_, angle, sine);
}

bool CertifiedEnd::bound(const ScatteringModel* model, const PlanePlace<ComplexBall>& p, Bound& bound) const {
  const ComplexBall square = range2(p), range = tight_root(square);
  bound.per_range = tight_inverse(range);
  if (!bound.per_range.is_finite()) return false;
  const ComplexRange r2(square), r(range);
  bound.least_range = std::sqrt(r2.least()) * down;
  bound.least_real_range = r.re_lo;
  if (!(bound.least_range > 0)) return false;
  bound.passed = 0;
  if (loss_ != nullptr) {
    double exponent = 0;
    for (const Trace& normal : rough_) {
      const ComplexRange w(squared(cosine(normal, p, bound)));
      const double sine2 = w.re_lo - std::abs(w.re_lo) * 1e-13;
      exponent += loss_->bend == 0 ? sine2 : 1 - (1 + loss_->bend) * (1 - sine2);
    }
    bound.passed = std::log(loss_->factor) - loss_->roughness * exponent + 1e-9;
  }
  if (model == nullptr) return true;
  if (piece_ == nullptr) return false;
  // |sine| = height / |range|. Its argument is half the argument of the squared range, with opposite sign.
  const double log_sine = std::log(over_.height.hi()) - std::log(bound.least_range) + 1e-12,
               sine_argument = r2.most_argument() / 2;
  const ComplexBall rho2 = squared(p.x - ComplexBall(over_.x)) + squared(p.y - ComplexBall(over_.y));
  // For the angle and for its square: range of the real parts, and largest distance from the real axis.
  double angle_lo = 0, angle_hi = 0, angle_aside = 0, square_lo = 0, square_hi = 0, square_aside = 0;
  const auto has = [&](double ScatteringModel::Term::*what) {
    return std::ranges::any_of(piece_->terms, [&](const auto& t) { return t.level != 0 && t.*what != 0; });
  };
  if (has(&ScatteringModel::Term::slope)) {
    // The derivative of atan(w) is 1 / (1 + w^2), which bounds the distance from the value at the real part
    // of w.
    const ComplexBall w = tight_root(rho2) * ComplexBall(Ball(1) / over_.height);
    if (!w.is_finite()) return false;
    const ComplexRange at(w), stretch(ComplexBall(1.0) + squared(w));
    if (!(stretch.least() > 0 && at.re_lo >= 0 && at.im_lo <= 0 && at.im_hi >= 0)) return false;
    angle_aside = at.most_im() / stretch.least() * up;
    angle_lo = std::atan(at.re_lo) * down - angle_aside;
    angle_hi = std::atan(at.re_hi) * up + angle_aside;
  }
  if (has(&ScatteringModel::Term::curvature)) {
    // atan(w)^2 is analytic in q = w^2. Its derivative is atan(w) / w, over 1 + q. The quotient atan(w) / w
    // is the mean of 1 / (1 + q u^2) over u from 0 to 1.
    const ComplexRange q(rho2 * ComplexBall(Ball(1) / squared(over_.height)));
    if (!(q.re_lo > -0.9 && q.re_hi < infinite && q.im_lo <= 0 && q.im_hi >= 0)) return false;
    const double least = 1 + std::min(q.re_lo, 0.0);
    square_aside = q.most_im() / (least * std::hypot(1 + q.re_lo, q.least_im())) * up;
    const auto angle2 = [](double x) {
      const double angle = x >= 0 ? std::atan(std::sqrt(x)) : std::atanh(std::sqrt(-x));
      return std::copysign(angle * angle, x);
    };
    const double low = angle2(q.re_lo), high = angle2(q.re_hi);
    square_lo = low - std::abs(low) * 1e-12 - square_aside;
    square_hi = high + std::abs(high) * 1e-12 + square_aside;
  }
  double sum = 0, argument = 0;
  int terms = 0;
  for (const ScatteringModel::Term& t : piece_->terms) {
    if (t.level == 0) continue;
    const double real = std::max(t.slope * (angle_lo - piece_->from), t.slope * (angle_hi - piece_->from)) -
                        std::min(t.curvature * square_lo, t.curvature * square_hi),
                 turned = t.power * sine_argument + std::abs(t.slope) * angle_aside +
                          std::abs(t.curvature) * square_aside;
    sum += t.level * std::exp(t.power * log_sine + real + 1e-12 * (1 + std::abs(real)));
    argument = std::max(argument, turned * up);
    ++terms;
  }
  // The square root of a sum is analytic where all terms stay on the same side of 0. The square root of a
  // single term is always analytic.
  if (terms > 1 && !(argument < 1.5)) return false;
  bound.cross_section = std::log(sum) + 1e-9;
  return true;
}

CertifiedPathEnergy::CertifiedPathEnergy(const CertifiedPolygon& polygon, const std::array<Ball, 3>& rx_m,
                                         const EchoModel& model, const SurfaceProperties& seabed,
                                         const Ball& beta_per_m)
    : tx_(polygon, {}),
      rx_(polygon, rx_m),
      tx_model_(seabed.scattering),
      rx_model_(seabed.scattering),
      beta_(beta_per_m) {
  take(model.path, seabed.factor, seabed.mu);
}

CertifiedPathEnergy::CertifiedPathEnergy(CertifiedEnd tx, CertifiedEnd rx, const Path& path,
                                         const std::array<const ScatteringModel*, 2>& models, double mu,
                                         const Ball& beta_per_m)
    : tx_(std::move(tx)), rx_(std::move(rx)), tx_model_(models[0]), rx_model_(models[1]), beta_(beta_per_m) {
  take(path, 1, mu);
}

void CertifiedPathEnergy::take(const Path& path, double factor, double mu) {
  tx_.take_loss(path.tx.loss);
  rx_.take_loss(path.back().loss);
  factor_ = tx_model_ != nullptr ? Ball(factor) : Ball(mu) * tx_.over().height * rx_.over().height;
  factor_in_doubles_ = interval_of(factor_);
  beta_in_doubles_ = interval_of(beta_);
  for (const ScatteringModel* model : {tx_model_, rx_model_})
    if (model != nullptr)
      smooth_rad_ = std::min(smooth_rad_, smooth_angle([&](double y) { return model->growth(y); }));
  for (const MirrorLoss* loss : {&path.tx.loss, &path.back().loss})
    if (!loss->rough_normals.empty())
      smooth_rad_ =
          std::min(smooth_rad_, 1 / std::sqrt(1 + loss->roughness * double(loss->rough_normals.size())));
}

/// Scattered part of the density, without the dependence on ranges.
Ball CertifiedPathEnergy::scattered(const PlanePlace<Ball>& p, const Ball& tx_range,
                                    const Ball& rx_range) const {
  const Ball value = factor_ * tx_.passed(p, tx_range) * rx_.passed(p, rx_range);
  if (tx_model_ == nullptr) return value;
  return value *
         root(tx_.cross_section(*tx_model_, p, tx_range) * rx_.cross_section(*rx_model_, p, rx_range));
}

Ball CertifiedPathEnergy::spread(const Ball& tx_range, const Ball& rx_range) const {
  const auto two_way = TwoWayRange<Ball>::of(tx_range, rx_range);
  return tx_model_ == nullptr ? lambert_density(two_way, beta_) : density(Ball(1), two_way, beta_);
}

Ball CertifiedPathEnergy::density_at(const PlanePlace<Ball>& p, const Ball& tx_range,
                                     const Ball& rx_range) const {
  const Ball sent = scattered(p, tx_range, rx_range);
  if (!is_wide(tx_range) && !is_wide(rx_range)) return sent * spread(tx_range, rx_range);
  // The value decreases with both ranges.
  const Ball most = spread(Ball(tx_range.lo()), Ball(rx_range.lo())),
             least = spread(Ball(tx_range.hi()), Ball(rx_range.hi()));
  return sent * Ball::between(std::max(least.lo(), 0.0), most.hi());
}

Interval CertifiedPathEnergy::density_at(const PlanePlace<Interval>& p, const Interval& tx_range,
                                         const Interval& rx_range) const {
  // All factors are positive and decrease with both ranges, so these intervals are as narrow as possible.
  const auto two_way = TwoWayRange<Interval>::of(tx_range, rx_range);
  const Interval sent = factor_in_doubles_ * tx_.passed(p, tx_range) * rx_.passed(p, rx_range);
  if (tx_model_ == nullptr) return sent * lambert_density(two_way, beta_in_doubles_);
  const Interval lobes =
      root(tx_.cross_section(*tx_model_, p, tx_range) * rx_.cross_section(*rx_model_, p, rx_range));
  return density(sent * lobes, two_way, beta_in_doubles_);
}

double CertifiedPathEnergy::log_bound(const PlanePlace<ComplexBall>& p, CertifiedEnd::Bound& tx,
                                      CertifiedEnd::Bound& rx) const {
  if (!tx_.bound(tx_model_, p, tx) || !rx_.bound(rx_model_, p, rx)) return infinite;
  const double power = tx_model_ == nullptr ? 3 : 2;
  double value = std::log(factor_.hi()) + tx.passed + rx.passed -
                 power * (std::log(tx.least_range) + std::log(rx.least_range)) -
                 beta_.lo() * std::max(tx.least_real_range + rx.least_real_range, 0.0);
  if (tx_model_ != nullptr) value += (tx.cross_section + rx.cross_section) / 2;
  return std::isnan(value) ? infinite : value + 1e-9 * (1 + std::abs(value));
}

bool CertifiedPathEnergy::has_pieces() const {
  return tx_model_ != nullptr && (tx_model_->pieces().size() > 1 || rx_model_->pieces().size() > 1);
}

bool CertifiedPathEnergy::take_pieces(const PlanePlace<Ball>& box) {
  return tx_model_ == nullptr || (tx_.take_piece(*tx_model_, box) && rx_.take_piece(*rx_model_, box));
}

void CertifiedPathEnergy::take_all_pieces() {
  tx_.take_all_pieces();
  rx_.take_all_pieces();
}

double CertifiedPathEnergy::scale_m(const PlanePlace<Ball>& p) const {
  return std::min(tx_.range(p).middle(), rx_.range(p).middle()) * smooth_rad_;
}

CertifiedPathGains::CertifiedPathGains(const CertifiedEnd& tx, const CertifiedEnd& rx,
                                       const TransmitPattern& transmit, std::span<const Directivity> receive)
    : any_(true) {
  const auto add = [&](const Directivity& pattern, const CertifiedEnd& end, std::vector<Gain>& gains) {
    gains.push_back({CertifiedGain(pattern), end.trace(pattern.axis), Ball(1), {}, 1});
    gains.back().trace_in_doubles = in_doubles(gains.back().trace);
    // Values above 1 cover the patterns' own rounding.
    gains.back().most_in_doubles = gains.back().largest().hi();
    gains.back().most = Ball(gains.back().most_in_doubles);
    tables_ = tables_ || gains.back().is_table();
    smooth_rad_ = std::min(smooth_rad_, smooth_angle([&](double y) { return pattern.growth(y); }));
  };
  for (const Directivity& beam : transmit.beams) add(beam, tx, transmit_);
  for (const Directivity& beam : receive) add(beam, rx, receive_);
}

Ball CertifiedPathGains::gain_at(const Gain& gain, const PlanePlace<Ball>& p, const Ball& range) const {
  if (gain.is_uniform()) return Ball(1);
  const Ball w = CertifiedEnd::cosine(gain.trace, p, range);
  const Ball value = gain.at(w, by_segment_, gain.most);
  const bool beyond = !value.is_finite() || (!by_segment_ && value.hi() > gain.most.hi());
  return beyond ? gain.most * Ball::between(0, 1) : value;
}

Interval CertifiedPathGains::gain_at(const Gain& gain, const PlanePlace<Interval>& p,
                                     const Interval& range) const {
  if (gain.is_uniform()) return 1;
  return gain.at(CertifiedEnd::cosine(gain.trace_in_doubles, p, range), by_segment_, gain.most_in_doubles);
}

/// The rectangle of the cosine is (f + u x + v y) / range, computed term by term.
double CertifiedPathGains::log_bound(const Gain& gain, const PlanePlace<ComplexRange>& p,
                                     const ComplexRange& per_range) const {
  if (gain.is_uniform()) return 0;
  const auto re = [](const ComplexRange& z) { return Interval(z.re_lo, z.re_hi); };
  const auto im = [](const ComplexRange& z) { return Interval(z.im_lo, z.im_hi); };
  const CertifiedEnd::IntervalTrace& trace = gain.trace_in_doubles;
  const Interval along = trace.at(re(p.x), re(p.y)),
                 across = trace.along_u * im(p.x) + trace.along_v * im(p.y),
                 w_re = along * re(per_range) - across * im(per_range),
                 w_im = along * im(per_range) + across * re(per_range);
  return gain.log_bound(ComplexRange(w_re.lo, w_re.hi, w_im.lo, w_im.hi));
}

void CertifiedPathGains::weigh(const PlanePlace<ComplexBall>& p, const CertifiedEnd::Bound& tx,
                               const CertifiedEnd::Bound& rx, std::vector<double>& bounds) const {
  if (!any_) return;
  const PlanePlace<ComplexRange> place{ComplexRange(p.x), ComplexRange(p.y)};
  const ComplexRange per_tx(tx.per_range), per_rx(rx.per_range);
  // The logarithm of a sum is computed from its largest term.
  double strongest = -infinite;
  std::vector<double> sent;
  for (const Gain& beam : transmit_) {
    sent.push_back(log_bound(beam, place, per_tx));
    strongest = std::max(strongest, std::isnan(sent.back()) ? infinite : sent.back());
  }
  double sum = 0;
  for (const double beam : sent) sum += std::exp(beam - strongest);
  const double all = strongest < infinite ? strongest + std::log(sum) + 1e-9 : infinite;
  for (std::size_t b = 0; b < receive_.size(); ++b) bounds[b] += all + log_bound(receive_[b], place, per_rx);
}

void CertifiedPathGains::take_segments(const PlanePlace<Ball>& box, const Ball& tx_range,
                                       const Ball& rx_range, std::vector<double>& off) {
  by_segment_ = tables_;
  if (!tables_) return;
  const auto take = [&](Gain& g, const Ball& range) {
    return g.take_segment(CertifiedEnd::cosine(g.trace, box, range));
  };
  double sent = 0;  // the relative error of a sum is at most that of one of its terms
  for (Gain& beam : transmit_) sent = std::max(sent, take(beam, tx_range));
  for (std::size_t b = 0; b < receive_.size(); ++b) off[b] += sent + take(receive_[b], rx_range);
}

bool CertifiedPathGains::has_no_zero(const PlanePlace<Ball>& box, const Ball& rx_range) const {
  return std::ranges::all_of(
      receive_, [&](const Gain& g) { return g.has_no_zero(CertifiedEnd::cosine(g.trace, box, rx_range)); });
}

double CertifiedPathIntegrand::scale_m(const PlanePlace<Ball>& place) const {
  return energy_.scale_m(place) * gains_.smooth_rad();
}

bool CertifiedPathIntegrand::take(const PlanePlace<Ball>& box, std::vector<double>& off) {
  if (!gains_.has_tables() && !energy_.has_pieces()) {
    gains_.take_tables();
    return energy_.take_pieces(box);
  }
  gains_.take_segments(box, energy_.tx().range(box), energy_.rx().range(box), off);
  return energy_.take_pieces(box);
}

void CertifiedPathIntegrand::take_whole() {
  gains_.take_tables();
  energy_.take_all_pieces();
}

void CertifiedPathIntegrand::log_bounds(const PlanePlace<ComplexBall>& place,
                                        std::vector<double>& bounds) const {
  CertifiedEnd::Bound tx, rx;
  double all = energy_.log_bound(place, tx, rx);
  if (all < infinite && texture_ != nullptr) all += std::log(texture_->largest_at(place.x, place.y)) + 1e-9;
  bounds.assign(gains_.beams(), std::isnan(all) ? infinite : all);
  if (all < infinite) gains_.weigh(place, tx, rx, bounds);
}

}  // namespace tubefoot
