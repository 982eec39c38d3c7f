// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/apparent_scattering.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

// Fits the angle of incidence phi on the true facet as an affine function of the apparent angle psi. The
// angles satisfy cos phi = e^ratio cos psi. The slopes of phi - stretch psi enclose the remainder. Near the
// normal, the slopes of phi^2 - stretch^2 psi^2 are used. See docs/notes/certified-energies.md, section
// "Through refracting water".
namespace tubefoot {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double rounding = 2e-15;  // of angles in doubles, and of the angles at which pieces of a model meet
constexpr double infinite = std::numeric_limits<double>::infinity();

Interval both_ways(double size) { return {-size, size}; }
Interval common(const Interval& a, const Interval& b) { return {std::max(a.lo, b.lo), std::min(a.hi, b.hi)}; }
/// Clips an interval of sines to [0, 1].
Interval sine_in(const Interval& s) { return {std::clamp(s.lo, 0.0, 1.0), std::clamp(s.hi, 0.0, 1.0)}; }

/// Angles of incidence, measured from the normal.
Interval incidence_of(const Interval& sine) {
  const Interval s = sine_in(sine);
  const Interval angle = outwards(std::acos(s.hi), std::acos(s.lo), library_units);
  return {std::max(angle.lo, 0.0), angle.hi};
}
Interval expm1(const Interval& x) { return outwards(std::expm1(x.lo), std::expm1(x.hi), library_units); }

/// x / sin x, which increases with x.
Interval over_sine(const Interval& x) {
  const auto at = [](double y) { return y < 1e-4 ? 1 + y * y / 6 : y / std::sin(y); };
  return outwards(at(x.lo), at(x.hi), 64);
}

/// Fit of the true angle of incidence phi as a function of the apparent angle psi: phi is about shift_rad +
/// stretch psi.
struct AngleFit {
  double shift_rad = 0, stretch = 1;
  /// Near the normal, angles are not smooth functions of position, but their squares are. The fit then has
  /// no shift.
  bool upright = false;
};

/// From cos phi = e^ratio cos psi follows phi' = e^ratio (sin psi / sin phi) psi' - ratio' / tan phi.
AngleFit fit_of(const GrazingPatch& middle, double log_ratio, double least_incidence_rad) {
  const double s = std::clamp(middle.sine.middle(), 0.0, 1.0),
               true_s = std::min(s * std::exp(log_ratio), 1.0), psi = std::acos(s), phi = std::acos(true_s);
  AngleFit fit{0, 1, least_incidence_rad < psi / 4};
  if (fit.upright) {
    fit.stretch = phi / psi;
  } else {
    const double sin_psi = std::sin(psi), sin_phi = std::sin(phi);
    const double psi_a = -middle.sine_a.middle() / sin_psi, psi_b = -middle.sine_b.middle() / sin_psi;
    const double turn = std::exp(log_ratio) * sin_psi / sin_phi, along = true_s / sin_phi;
    const double phi_a = turn * psi_a - along * middle.ratio_a.middle(),
                 phi_b = turn * psi_b - along * middle.ratio_b.middle();
    fit.stretch = (phi_a * psi_a + phi_b * psi_b) / (psi_a * psi_a + psi_b * psi_b);
  }
  if (!(fit.stretch > 0.5 && fit.stretch < 2)) fit.stretch = 1;
  if (!fit.upright) fit.shift_rad = phi - fit.stretch * psi;
  return fit;
}

/// Slopes of phi - stretch psi, and of phi^2 - stretch^2 psi^2.
struct AngleSlopes {
  Interval angle_a, angle_b, square_a, square_b;

  static AngleSlopes of(const GrazingPatch& at, const Interval& log_ratio, double stretch) {
    const Interval s = sine_in(at.sine), ratio = exp(log_ratio), cosine2 = 1.0 - squared(s);
    // sin^2 phi / sin^2 psi
    const Interval turn2 = 1.0 - expm1(2.0 * log_ratio) * squared(s) / cosine2;
    const Interval sin_psi = root(cosine2), turn = root(turn2);
    const bool smooth = cosine2.surely_positive() && turn2.surely_positive();
    const auto angle = [&](const Interval& of_sine, const Interval& of_ratio) {
      if (!smooth) return outwards(1, 0);
      return (ratio / turn - stretch) * (-of_sine / sin_psi) - ratio * s / (sin_psi * turn) * of_ratio;
    };
    // With K(x) = x / sin x, (x^2)' = -2 K s'. The slope of K as a function of x^2 is at most 1 / pi.
    const Interval true_s = ratio * s, phi = over_sine(incidence_of(true_s)),
                   psi = over_sine(incidence_of(s));
    const double apart =
        2 / pi * std::max(phi.hi, psi.hi) * std::max(s.hi, true_s.hi) * log_ratio.largest() * (1 + 1e-9);
    const Interval turned = expm1(log_ratio) * phi + common(phi - psi, both_ways(apart)) +
                            (1.0 - Interval(stretch) * stretch) * psi;
    const auto square = [&](const Interval& of_sine, const Interval& of_ratio) {
      return -2.0 * (turned * of_sine + phi * true_s * of_ratio);
    };
    return {angle(at.sine_a, at.ratio_a), angle(at.sine_b, at.ratio_b), square(at.sine_a, at.ratio_a),
            square(at.sine_b, at.ratio_b)};
  }
};

/// Upper bound of |d log sigma / d phi| of a piece up to an angle.
double steepest(const ScatteringModel::Piece& piece, double incidence_rad) {
  double most = 0;
  for (const ScatteringModel::Term& t : piece.terms)
    most = std::max(most, std::abs(t.slope) + 2 * t.curvature * incidence_rad +
                              (t.power == 0             ? 0
                               : incidence_rad < pi / 2 ? t.power * std::tan(incidence_rad)
                                                        : infinite));
  return most;
}

/// Bounds the logarithm of the ratio between a model and the continuation of one piece's terms beyond its
/// end. Two angles that differ by `off_rad` may lie on opposite sides of an end of a piece. The first of
/// them lies in `incidence`.
double over_ends(const ScatteringModel& model, const Interval& incidence, double off_rad) {
  const auto& pieces = model.pieces();
  std::vector<std::pair<double, double>> ends;  // angle, and the bound of the change there
  for (std::size_t k = 0; k + 1 < pieces.size(); ++k) {
    const double end = pieces[k].to;
    if (end < incidence.lo - off_rad || end > incidence.hi + off_rad) continue;
    const double sine = std::cos(end);
    const double jump = std::abs(std::log(ScatteringModel::in_piece(pieces[k], end, sine) /
                                          ScatteringModel::in_piece(pieces[k + 1], end, sine)));
    ends.emplace_back(
        end, jump + off_rad * (steepest(pieces[k], end + off_rad) + steepest(pieces[k + 1], end + off_rad)));
  }
  double most = 0;
  for (std::size_t first = 0; first < ends.size(); ++first) {
    double sum = 0;  // sum over the ends that may lie between the two angles
    for (std::size_t k = first; k < ends.size() && ends[k].first <= ends[first].first + 2 * off_rad; ++k)
      sum += ends[k].second;
    most = std::max(most, sum);
  }
  return most;
}

}  // namespace

std::optional<ApparentScattering> apparent_scattering(
    const ScatteringModel& model, const GrazingPatch& middle, const Interval& log_ratio,
    std::span<const GrazingPatch> over,
    const std::function<Interval(const Interval& a, const Interval& b)>& spread) {
  GrazingPatch all = over.front();
  for (const GrazingPatch& patch : over.subspan(1))
    for (Interval GrazingPatch::*part : {&GrazingPatch::sine, &GrazingPatch::ratio_a, &GrazingPatch::ratio_b})
      all.*part = hull(all.*part, patch.*part);
  const Interval ratio = log_ratio + spread(all.ratio_a, all.ratio_b);
  if (!ratio.is_finite() || !(all.sine.lo > 0)) return std::nullopt;
  const double fitted_ratio = log_ratio.middle();
  const Interval psi = incidence_of(all.sine);
  const AngleFit fit = fit_of(middle, fitted_ratio, psi.lo);

  AngleSlopes slopes = AngleSlopes::of(over.front(), ratio, fit.stretch);
  for (const GrazingPatch& patch : over.subspan(1)) {
    const AngleSlopes own = AngleSlopes::of(patch, ratio, fit.stretch);
    for (Interval AngleSlopes::*part :
         {&AngleSlopes::angle_a, &AngleSlopes::angle_b, &AngleSlopes::square_a, &AngleSlopes::square_b})
      slopes.*part = hull(slopes.*part, own.*part);
  }
  const Interval phi = incidence_of(exp(ratio) * sine_in(all.sine));
  const Interval phi_middle = incidence_of(exp(log_ratio) * middle.sine),
                 psi_middle = incidence_of(middle.sine);
  const Interval square = squared(phi_middle) - fit.stretch * fit.stretch * squared(psi_middle) +
                          spread(slopes.square_a, slopes.square_b) + both_ways(rounding);
  // For non-negative numbers, the square of their difference is at most the difference of their squares.
  Interval angle = both_ways(std::sqrt(square.largest()) * (1 + 1e-9));
  angle = common(angle, phi_middle - fit.stretch * psi_middle + spread(slopes.angle_a, slopes.angle_b));
  if (const Interval sum = phi + fit.stretch * psi; sum.surely_positive())
    angle = common(angle, square / sum);
  const Interval off = angle - fit.shift_rad + both_ways(rounding);
  if (!off.is_finite() || !(off.lo <= off.hi)) return std::nullopt;

  std::optional<Interval> rest;
  for (std::size_t k = 0; k < model.pieces().size(); ++k) {
    const ScatteringModel::Piece& piece = model.pieces()[k];
    const bool last = k + 1 == model.pieces().size();
    if (phi.hi + off.largest() < piece.from || (!last && phi.lo - off.largest() > piece.to)) continue;
    for (const ScatteringModel::Term& t : piece.terms) {
      const Interval exponent =
          fit.upright ? t.slope * off - t.curvature * square
                      : off * (t.slope - t.curvature * (phi + fit.shift_rad + fit.stretch * psi));
      const Interval own = exponent + (t.power - 2) * ratio - t.power * fitted_ratio;
      rest = rest ? hull(*rest, own) : own;
    }
  }
  // A model is a sum of positive terms, so the ratio of two models lies between the ratios of their terms.
  ApparentScattering found{model.of_angle(fit.shift_rad, fit.stretch, std::exp(fitted_ratio)), {}};
  found.rest = *rest + both_ways(over_ends(model, phi, off.largest()) + 1e-12);
  if (!found.rest.is_finite()) return std::nullopt;
  return found;
}

double largest_cross_section(const ScatteringModel& model, const Interval& sine) {
  const Interval s = sine_in(sine), incidence = incidence_of(s);
  double most = 0;
  for (std::size_t k = 0; k < model.pieces().size(); ++k) {
    const ScatteringModel::Piece& piece = model.pieces()[k];
    const bool last = k + 1 == model.pieces().size();
    const double lo = std::max(incidence.lo, piece.from - rounding),
                 hi = last ? incidence.hi : std::min(incidence.hi, piece.to + rounding);
    if (!(lo <= hi)) continue;
    double sum = 0;
    for (const ScatteringModel::Term& t : piece.terms)
      sum += t.level * std::pow(s.hi, t.power) *
             std::exp(std::max(t.slope * (lo - piece.from), t.slope * (hi - piece.from)) -
                      t.curvature * lo * lo);
    most = std::max(most, sum);
  }
  return most * (1 + 1e-12);
}

}  // namespace tubefoot
