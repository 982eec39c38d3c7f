// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_path_energy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/certified/certified_scattering.hpp"
#include "engine/law/density.hpp"
#include "geometry/numbers/complex_ranges.hpp"

namespace tubefoot {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Of many places, not of one and its rounding.
bool is_wide(const Ball& x) { return arb_rel_accuracy_bits(x.get()) < 20; }

/// Far above the rounding of doubles.
constexpr double up = 1 + 1e-12, down = 1 - 1e-12;

bool depends_on_angle(const ScatteringLaw::Piece& piece) {
  return std::ranges::any_of(piece.terms, [](const ScatteringLaw::Term& t) {
    return t.level != 0 && (t.slope != 0 || t.curvature != 0);
  });
}

/// An angle whose imaginary part of that size lets growth(y) multiply by e, at most 1.
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
}

CertifiedEnd::CertifiedEnd(const ApexOverPlane& over, const LyingPlane& seen) : over_(over) {
  for (int k = 0; k < 3; ++k) {
    to_foot_[std::size_t(k)] = Ball(seen.foot_m[k]);
    u_[std::size_t(k)] = Ball(seen.u[k]);
    v_[std::size_t(k)] = Ball(seen.v[k]);
  }
}

CertifiedEnd::Trace CertifiedEnd::trace(const glm::dvec3& axis) const {
  const auto along = [&](const std::array<Ball, 3>& e) {
    return Ball(axis.x) * e[0] + Ball(axis.y) * e[1] + Ball(axis.z) * e[2];
  };
  return {along(to_foot_), along(u_), along(v_)};
}

Ball CertifiedEnd::range(const PlanePlace<Ball>& p) const {
  Ball r = root(squared(over_.height) + squared(p.x - over_.x) + squared(p.y - over_.y));
  // Balls of squares reach below 0: where places are many, that is to be said.
  if (is_wide(r) && r.lo() < over_.height.lo()) r = Ball::between(over_.height.lo(), r.hi());
  return r;
}

ComplexBall CertifiedEnd::range2(const PlanePlace<ComplexBall>& p) const {
  return ComplexBall(squared(over_.height)) + squared(p.x - ComplexBall(over_.x)) +
         squared(p.y - ComplexBall(over_.y));
}

void CertifiedEnd::take_loss(const MirrorLoss& loss) {
  loss_ = loss.none() ? nullptr : &loss;
  rough_.clear();
  for (const glm::dvec3& normal : loss.rough_normals) rough_.push_back(trace(normal));
}

Ball CertifiedEnd::cosine(const Trace& trace, const PlanePlace<Ball>& p, const Ball& range) {
  const Ball w = trace.at(p) / range;
  if (w.lo() >= -1 && w.hi() <= 1) return w;
  const auto in = [](double x, double otherwise) {  // no cosine is beyond
    return std::isnan(x) ? otherwise : std::clamp(x, -1.0, 1.0);
  };
  return Ball::between(in(w.lo(), -1), in(w.hi(), 1));
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

Ball CertifiedEnd::incidence(const PlanePlace<Ball>& p) const {
  return atan2(root(squared(p.x - over_.x) + squared(p.y - over_.y)), over_.height);
}

bool CertifiedEnd::take_piece(const ScatteringLaw& law, const PlanePlace<Ball>& box) {
  const auto& pieces = law.pieces();
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

Ball CertifiedEnd::cross_section(const ScatteringLaw& law, const PlanePlace<Ball>& p,
                                 const Ball& range) const {
  const Ball sine = over_.height / range;
  if (piece_ == nullptr) return cross_section_over(law, incidence(p), sine);
  return cross_section_in(*piece_, depends_on_angle(*piece_) ? incidence(p) : Ball(), sine);
}

bool CertifiedEnd::bound(const ScatteringLaw* law, const PlanePlace<ComplexBall>& p, Bound& bound) const {
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
  if (law == nullptr) return true;
  if (piece_ == nullptr) return false;
  // |sine| = height / |range|, and its argument is half that of the square, the other way.
  const double log_sine = std::log(over_.height.hi()) - std::log(bound.least_range) + 1e-12,
               sine_argument = r2.most_argument() / 2;
  const ComplexBall rho2 = squared(p.x - ComplexBall(over_.x)) + squared(p.y - ComplexBall(over_.y));
  // Of the angle and of its square: where their real parts are, and how far they may be from real.
  double angle_lo = 0, angle_hi = 0, angle_aside = 0, square_lo = 0, square_hi = 0, square_aside = 0;
  const auto has = [&](double ScatteringLaw::Term::*what) {
    return std::ranges::any_of(piece_->terms, [&](const auto& t) { return t.level != 0 && t.*what != 0; });
  };
  if (has(&ScatteringLaw::Term::slope)) {
    // The derivative of atan(w) is 1 / (1 + w^2): no farther from its value at w's real part than that says.
    const ComplexBall w = tight_root(rho2) * ComplexBall(Ball(1) / over_.height);
    if (!w.is_finite()) return false;
    const ComplexRange at(w), stretch(ComplexBall(1.0) + squared(w));
    if (!(stretch.least() > 0 && at.re_lo >= 0 && at.im_lo <= 0 && at.im_hi >= 0)) return false;
    angle_aside = at.most_im() / stretch.least() * up;
    angle_lo = std::atan(at.re_lo) * down - angle_aside;
    angle_hi = std::atan(at.re_hi) * up + angle_aside;
  }
  if (has(&ScatteringLaw::Term::curvature)) {
    // atan(w)^2 is analytic in q = w^2. Its derivative is atan(w) / w, which is the mean of 1 / (1 + q u^2)
    // over u from 0 to 1, over 1 + q.
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
  for (const ScatteringLaw::Term& t : piece_->terms) {
    if (t.level == 0) continue;
    const double real = std::max(t.slope * (angle_lo - piece_->from), t.slope * (angle_hi - piece_->from)) -
                        std::min(t.curvature * square_lo, t.curvature * square_hi),
                 turned = t.power * sine_argument + std::abs(t.slope) * angle_aside +
                          std::abs(t.curvature) * square_aside;
    sum += t.level * std::exp(t.power * log_sine + real + 1e-12 * (1 + std::abs(real)));
    argument = std::max(argument, turned * up);
    ++terms;
  }
  // The root of a sum is analytic where its terms stay on the same side of 0; that of one term anyway.
  if (terms > 1 && !(argument < 1.5)) return false;
  bound.cross_section = std::log(sum) + 1e-9;
  return true;
}

CertifiedPathEnergy::CertifiedPathEnergy(const CertifiedPolygon& polygon, const std::array<Ball, 3>& home_m,
                                         const EchoLaw& law, const FacetBed& bed, const Ball& beta_per_m)
    : out_(polygon, {}),
      home_(polygon, home_m),
      out_law_(bed.scattering),
      home_law_(bed.scattering),
      beta_(beta_per_m) {
  take(law.path, bed.factor, bed.mu);
}

CertifiedPathEnergy::CertifiedPathEnergy(CertifiedEnd out, CertifiedEnd home, const Path& path,
                                         const std::array<const ScatteringLaw*, 2>& laws, double mu,
                                         const Ball& beta_per_m)
    : out_(std::move(out)), home_(std::move(home)), out_law_(laws[0]), home_law_(laws[1]), beta_(beta_per_m) {
  take(path, 1, mu);
}

void CertifiedPathEnergy::take(const Path& path, double factor, double mu) {
  out_.take_loss(path.out.loss);
  home_.take_loss(path.back().loss);
  factor_ = out_law_ != nullptr ? Ball(factor) : Ball(mu) * out_.over().height * home_.over().height;
  for (const ScatteringLaw* law : {out_law_, home_law_})
    if (law != nullptr)
      smooth_rad_ = std::min(smooth_rad_, smooth_angle([&](double y) { return law->growth(y); }));
  for (const MirrorLoss* loss : {&path.out.loss, &path.back().loss})
    if (!loss->rough_normals.empty())
      smooth_rad_ =
          std::min(smooth_rad_, 1 / std::sqrt(1 + loss->roughness * double(loss->rough_normals.size())));
}

/// But for what ranges take of it.
Ball CertifiedPathEnergy::scattered(const PlanePlace<Ball>& p, const Ball& out_range,
                                    const Ball& home_range) const {
  const Ball value = factor_ * out_.passed(p, out_range) * home_.passed(p, home_range);
  if (out_law_ == nullptr) return value;
  return value *
         root(out_.cross_section(*out_law_, p, out_range) * home_.cross_section(*home_law_, p, home_range));
}

Ball CertifiedPathEnergy::spread(const Ball& out_range, const Ball& home_range) const {
  const auto way = Way<Ball>::of(out_range, home_range);
  return out_law_ == nullptr ? lambert_density(way, beta_) : density(Ball(1), way, beta_);
}

Ball CertifiedPathEnergy::density_at(const PlanePlace<Ball>& p, const Ball& out_range,
                                     const Ball& home_range) const {
  const Ball sent = scattered(p, out_range, home_range);
  if (!is_wide(out_range) && !is_wide(home_range)) return sent * spread(out_range, home_range);
  // The farther, the less.
  const Ball most = spread(Ball(out_range.lo()), Ball(home_range.lo())),
             least = spread(Ball(out_range.hi()), Ball(home_range.hi()));
  return sent * Ball::between(std::max(least.lo(), 0.0), most.hi());
}

double CertifiedPathEnergy::log_bound(const PlanePlace<ComplexBall>& p, CertifiedEnd::Bound& out,
                                      CertifiedEnd::Bound& home) const {
  if (!out_.bound(out_law_, p, out) || !home_.bound(home_law_, p, home)) return infinite;
  const double power = out_law_ == nullptr ? 3 : 2;
  double value = std::log(factor_.hi()) + out.passed + home.passed -
                 power * (std::log(out.least_range) + std::log(home.least_range)) -
                 beta_.lo() * std::max(out.least_real_range + home.least_real_range, 0.0);
  if (out_law_ != nullptr) value += (out.cross_section + home.cross_section) / 2;
  return std::isnan(value) ? infinite : value + 1e-9 * (1 + std::abs(value));
}

bool CertifiedPathEnergy::take_pieces(const PlanePlace<Ball>& box) {
  return out_law_ == nullptr || (out_.take_piece(*out_law_, box) && home_.take_piece(*home_law_, box));
}

void CertifiedPathEnergy::take_all_pieces() {
  out_.take_all_pieces();
  home_.take_all_pieces();
}

double CertifiedPathEnergy::scale_m(const PlanePlace<Ball>& p) const {
  return std::min(out_.range(p).middle(), home_.range(p).middle()) * smooth_rad_;
}

CertifiedPathGains::CertifiedPathGains(const CertifiedEnd& out, const CertifiedEnd& home,
                                       const TransmitPattern& transmit, std::span<const Directivity> receive)
    : any_(true) {
  const auto add = [&](const Directivity& pattern, const CertifiedEnd& end, std::vector<Gain>& gains) {
    gains.push_back({CertifiedGain(pattern), end.trace(pattern.axis), Ball()});
    gains.back().most = Ball(gains.back().largest().hi());
    tables_ = tables_ || gains.back().is_table();
    smooth_rad_ = std::min(smooth_rad_, smooth_angle([&](double y) { return pattern.growth(y); }));
  };
  for (const Directivity& beam : transmit.beams) add(beam, out, transmit_);
  for (const Directivity& beam : receive) add(beam, home, receive_);
}

void CertifiedPathGains::weigh(const PlanePlace<Ball>& p, const Ball& out_range, const Ball& home_range,
                               std::vector<Ball>& values) const {
  if (!any_) return;
  const auto gain = [&](const Gain& g, const Ball& range) {
    if (g.is_uniform()) return Ball(1);
    const Ball w = CertifiedEnd::cosine(g.trace, p, range);
    const Ball value = g.at(w, by_segment_, g.most);
    const bool beyond = !value.is_finite() || (!by_segment_ && value.hi() > g.most.hi());
    return beyond ? g.most * Ball::between(0, 1) : value;
  };
  Ball sent;
  for (const Gain& beam : transmit_) sent += gain(beam, out_range);
  for (std::size_t b = 0; b < receive_.size(); ++b)
    values[b] = values[b] * sent * gain(receive_[b], home_range);
}

void CertifiedPathGains::weigh(const PlanePlace<ComplexBall>& p, const CertifiedEnd::Bound& out,
                               const CertifiedEnd::Bound& home, std::vector<double>& bounds) const {
  if (!any_) return;
  const auto bound = [&](const Gain& g, const CertifiedEnd::Bound& end) {
    return g.is_uniform() ? 0.0 : g.log_bound(CertifiedEnd::cosine(g.trace, p, end));
  };
  // The logarithm of a sum, from its largest term.
  double strongest = -infinite;
  std::vector<double> sent;
  for (const Gain& beam : transmit_) {
    sent.push_back(bound(beam, out));
    strongest = std::max(strongest, std::isnan(sent.back()) ? infinite : sent.back());
  }
  double sum = 0;
  for (const double beam : sent) sum += std::exp(beam - strongest);
  const double all = strongest < infinite ? strongest + std::log(sum) + 1e-9 : infinite;
  for (std::size_t b = 0; b < receive_.size(); ++b) bounds[b] += all + bound(receive_[b], home);
}

void CertifiedPathGains::take_segments(const PlanePlace<Ball>& box, const Ball& out_range,
                                       const Ball& home_range, std::vector<double>& off) {
  by_segment_ = tables_;
  if (!tables_) return;
  const auto take = [&](Gain& g, const Ball& range) {
    return g.take_segment(CertifiedEnd::cosine(g.trace, box, range));
  };
  double sent = 0;  // a sum is wrong by no more, relatively, than one of its terms
  for (Gain& beam : transmit_) sent = std::max(sent, take(beam, out_range));
  for (std::size_t b = 0; b < receive_.size(); ++b) off[b] += sent + take(receive_[b], home_range);
}

bool CertifiedPathGains::has_no_zero(const PlanePlace<Ball>& box, const Ball& home_range) const {
  return std::ranges::all_of(
      receive_, [&](const Gain& g) { return g.has_no_zero(CertifiedEnd::cosine(g.trace, box, home_range)); });
}

double CertifiedPathIntegrand::scale_m(const PlanePlace<Ball>& place) const {
  return energy_.scale_m(place) * gains_.smooth_rad();
}

void CertifiedPathIntegrand::at(const PlanePlace<Ball>& place, std::vector<Ball>& values) const {
  const Ball out = energy_.out().range(place), home = energy_.home().range(place);
  Ball value = energy_.density_at(place, out, home);
  if (texture_ != nullptr) value = value * texture_->factor_at(place.x, place.y);
  values.assign(gains_.beams(), value);
  gains_.weigh(place, out, home, values);
}

bool CertifiedPathIntegrand::take(const PlanePlace<Ball>& box, std::vector<double>& off) {
  gains_.take_segments(box, energy_.out().range(box), energy_.home().range(box), off);
  return energy_.take_pieces(box);
}

void CertifiedPathIntegrand::take_whole() {
  gains_.take_tables();
  energy_.take_all_pieces();
}

void CertifiedPathIntegrand::log_bounds(const PlanePlace<ComplexBall>& place,
                                        std::vector<double>& bounds) const {
  CertifiedEnd::Bound out, home;
  double all = energy_.log_bound(place, out, home);
  if (all < infinite && texture_ != nullptr) all += std::log(texture_->largest_at(place.x, place.y)) + 1e-9;
  bounds.assign(gains_.beams(), std::isnan(all) ? infinite : all);
  if (all < infinite) gains_.weigh(place, out, home, bounds);
}

}  // namespace tubefoot
