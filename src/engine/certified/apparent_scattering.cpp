// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/apparent_scattering.hpp"

#include <algorithm>
#include <cmath>

#include "engine/certified/reference.hpp"
#include "geometry/numbers/scalars.hpp"

// Fits the angle of incidence phi on the true facet as an affine function of the apparent angle psi. The
// angles satisfy cos phi = e^log_ratio cos psi. The derivatives of phi - slope psi enclose the remainder.
// Near the normal, the derivatives of phi^2 - slope^2 psi^2 are used. The suffixes _a and _b denote
// derivatives along the two directions of the facet's plane. A term of a scattering model is level
// sin^power(grazing) exp(slope (phi - from) - curvature phi^2) with level, power and curvature >= 0. See
// docs/notes/certified-energies.md, section "Through refracting water".
namespace tubefoot {
namespace {

constexpr double angle_rounding =
    2e-15;  // of angles [rad] in doubles, and of the angles at which pieces meet

Interval symmetric(double size) { return {-size, size}; }
Interval intersection(const Interval& a, const Interval& b) {
  return {std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
}
/// Clips an interval of sines to [0, 1].
Interval clamped_sine(const Interval& s) { return {std::clamp(s.lo, 0.0, 1.0), std::clamp(s.hi, 0.0, 1.0)}; }

/// Angles of incidence phi, measured from the normal, whose cosines are the given sines of grazing angles.
Interval incidence_of(const Interval& sine) {
  const Interval s = clamped_sine(sine);
  const Interval angle = outwards(std::acos(s.hi), std::acos(s.lo), library_units);
  return {std::max(angle.lo, 0.0), angle.hi};
}
Interval expm1(const Interval& x) { return outwards(std::expm1(x.lo), std::expm1(x.hi), library_units); }

/// K(x) = x / sin x, which increases on [0, pi).
Interval x_over_sin_x(const Interval& x) {
  const auto at = [](double y) { return y < 1e-4 ? 1 + y * y / 6 : y / std::sin(y); };
  return outwards(at(x.lo), at(x.hi), 64);
}

/// Fit of the true angle of incidence phi as a function of the apparent angle psi: phi is about offset_rad +
/// slope psi.
struct AngleFit {
  double offset_rad = 0, slope = 1;
  /// Near the normal, angles are not smooth functions of position, but their squares are. The fit then has
  /// no offset.
  bool near_normal = false;
};

/// From cos phi = e^log_ratio cos psi follows phi' = e^log_ratio (sin psi / sin phi) psi' - log_ratio' / tan
/// phi. A slope outside (0.5, 2), or one that is not a number at grazing or normal incidence, becomes 1.
AngleFit fit_of(const GrazingPatch& middle, double log_ratio, double least_incidence_rad) {
  const double cos_psi = std::clamp(middle.sine.middle(), 0.0, 1.0),
               cos_phi = std::min(cos_psi * std::exp(log_ratio), 1.0), psi = std::acos(cos_psi),
               phi = std::acos(cos_phi);
  AngleFit fit{0, 1, least_incidence_rad < psi / 4};
  if (fit.near_normal) {
    fit.slope = phi / psi;
  } else {
    const double sin_psi = std::sin(psi), sin_phi = std::sin(phi);
    const double psi_a = -middle.sine_a.middle() / sin_psi, psi_b = -middle.sine_b.middle() / sin_psi;
    const double dphi_dpsi = std::exp(log_ratio) * sin_psi / sin_phi, cot_phi = cos_phi / sin_phi;
    const double phi_a = dphi_dpsi * psi_a - cot_phi * middle.ratio_a.middle(),
                 phi_b = dphi_dpsi * psi_b - cot_phi * middle.ratio_b.middle();
    fit.slope = (phi_a * psi_a + phi_b * psi_b) / (psi_a * psi_a + psi_b * psi_b);
  }
  if (!(fit.slope > 0.5 && fit.slope < 2)) fit.slope = 1;
  if (!fit.near_normal) fit.offset_rad = phi - fit.slope * psi;
  return fit;
}

/// Derivatives of phi - slope psi, and of phi^2 - slope^2 psi^2.
struct AngleDerivatives {
  Interval angle_a, angle_b, square_a, square_b;

  static AngleDerivatives of(const GrazingPatch& at, const Interval& log_ratio, double slope) {
    const Interval cos_psi = clamped_sine(at.sine), ratio = exp(log_ratio), cos_phi = ratio * cos_psi,
                   sin_psi2 = 1.0 - squared(cos_psi);
    const Interval sine_ratio2 = 1.0 - expm1(2.0 * log_ratio) * squared(cos_psi) / sin_psi2;
    const Interval sin_psi = root(sin_psi2), sine_ratio = root(sine_ratio2);  // sin phi / sin psi
    const bool smooth = sin_psi2.surely_positive() && sine_ratio2.surely_positive();
    const auto angle = [&](const Interval& dsine, const Interval& dlog_ratio) {
      if (!smooth) return outwards(1, 0);  // no bound
      return (ratio / sine_ratio - slope) * (-dsine / sin_psi) -
             ratio * cos_psi / (sin_psi * sine_ratio) * dlog_ratio;
    };
    // With K(x) = x / sin x, (x^2)' = -2 K(x) (cos x)'. The derivative of K with respect to x^2 is at most
    // 1 / pi on [0, pi / 2]. Furthermore, |phi^2 - psi^2| <= 2 max K max cos |log_ratio|.
    const Interval k_phi = x_over_sin_x(incidence_of(cos_phi)), k_psi = x_over_sin_x(incidence_of(cos_psi));
    const double largest_k_difference = 2 / pi * std::max(k_phi.hi, k_psi.hi) *
                                        std::max(cos_psi.hi, cos_phi.hi) * log_ratio.largest() * (1 + 1e-9);
    // K(phi) e^log_ratio - slope^2 K(psi), without cancellation
    const Interval sine_coefficient = expm1(log_ratio) * k_phi +
                                      intersection(k_phi - k_psi, symmetric(largest_k_difference)) +
                                      (1.0 - Interval(slope) * slope) * k_psi;
    const auto square = [&](const Interval& dsine, const Interval& dlog_ratio) {
      return -2.0 * (sine_coefficient * dsine + k_phi * cos_phi * dlog_ratio);
    };
    return {angle(at.sine_a, at.ratio_a), angle(at.sine_b, at.ratio_b), square(at.sine_a, at.ratio_a),
            square(at.sine_b, at.ratio_b)};
  }
};

/// Upper bound of |d log sigma / d phi| of a piece up to an angle. The logarithmic derivative of a sum of
/// positive terms is a weighted mean of theirs.
double largest_log_slope(const ScatteringModel::Piece& piece, double incidence_rad) {
  double most = 0;
  for (const ScatteringModel::Term& t : piece.terms)
    most = std::max(most, std::abs(t.slope) + 2 * t.curvature * incidence_rad +
                              (t.power == 0             ? 0
                               : incidence_rad < pi / 2 ? t.power * std::tan(incidence_rad)
                                                        : infinite));
  return most;
}

/// Bounds the logarithm of the ratio between a model and the continuation of one piece's terms beyond the
/// angle at which the piece ends (breakpoint). Two angles that differ by `difference_rad` may lie on opposite
/// sides of a breakpoint. The first of them lies in `incidence`.
double change_at_breakpoints(const ScatteringModel& model, const Interval& incidence, double difference_rad) {
  const auto& pieces = model.pieces();
  std::vector<std::pair<double, double>> breakpoints;  // angle, and the bound of the change there
  for (std::size_t k = 0; k + 1 < pieces.size(); ++k) {
    const double angle = pieces[k].to;
    if (angle < incidence.lo - difference_rad || angle > incidence.hi + difference_rad) continue;
    const double sine = std::cos(angle);
    const double jump = std::abs(std::log(ScatteringModel::in_piece(pieces[k], angle, sine) /
                                          ScatteringModel::in_piece(pieces[k + 1], angle, sine)));
    breakpoints.emplace_back(
        angle, jump + difference_rad * (largest_log_slope(pieces[k], angle + difference_rad) +
                                        largest_log_slope(pieces[k + 1], angle + difference_rad)));
  }
  double most = 0;
  for (std::size_t first = 0; first < breakpoints.size(); ++first) {
    double sum = 0;  // over the breakpoints that may lie between the two angles
    for (std::size_t k = first;
         k < breakpoints.size() && breakpoints[k].first <= breakpoints[first].first + 2 * difference_rad; ++k)
      sum += breakpoints[k].second;
    most = std::max(most, sum);
  }
  return most;
}

}  // namespace

std::optional<ApparentScattering> apparent_scattering(
    const ScatteringModel& model, const GrazingPatch& middle, const Interval& log_ratio,
    std::span<const GrazingPatch> patches,
    const std::function<Interval(const Interval& a, const Interval& b)>& largest_change) {
  GrazingPatch all = patches.front();
  for (const GrazingPatch& patch : patches.subspan(1))
    for (Interval GrazingPatch::*part : {&GrazingPatch::sine, &GrazingPatch::ratio_a, &GrazingPatch::ratio_b})
      all.*part = hull(all.*part, patch.*part);
  const Interval log_ratio_here = log_ratio + largest_change(all.ratio_a, all.ratio_b);
  if (!log_ratio_here.is_finite() || !(all.sine.lo > 0)) return std::nullopt;
  const double fitted_log_ratio = log_ratio.middle();
  const Interval psi = incidence_of(all.sine);
  const AngleFit fit = fit_of(middle, fitted_log_ratio, psi.lo);

  AngleDerivatives derivatives = AngleDerivatives::of(patches.front(), log_ratio_here, fit.slope);
  for (const GrazingPatch& patch : patches.subspan(1)) {
    const AngleDerivatives own = AngleDerivatives::of(patch, log_ratio_here, fit.slope);
    for (Interval AngleDerivatives::*part : {&AngleDerivatives::angle_a, &AngleDerivatives::angle_b,
                                             &AngleDerivatives::square_a, &AngleDerivatives::square_b})
      derivatives.*part = hull(derivatives.*part, own.*part);
  }
  const Interval phi = incidence_of(exp(log_ratio_here) * clamped_sine(all.sine));
  const Interval phi_middle = incidence_of(exp(log_ratio) * middle.sine),
                 psi_middle = incidence_of(middle.sine);
  const Interval square_difference = squared(phi_middle) - fit.slope * fit.slope * squared(psi_middle) +
                                     largest_change(derivatives.square_a, derivatives.square_b) +
                                     symmetric(angle_rounding);
  // For non-negative numbers, the square of their difference is at most the absolute difference of their
  // squares.
  Interval angle = symmetric(std::sqrt(square_difference.largest()) * (1 + 1e-9));
  angle = intersection(
      angle, phi_middle - fit.slope * psi_middle + largest_change(derivatives.angle_a, derivatives.angle_b));
  if (const Interval sum = phi + fit.slope * psi; sum.surely_positive())
    angle = intersection(angle, square_difference / sum);
  const Interval residual = angle - fit.offset_rad + symmetric(angle_rounding);
  if (!residual.is_finite() || !(residual.lo <= residual.hi)) return std::nullopt;

  std::optional<Interval> remainder;
  for (std::size_t k = 0; k < model.pieces().size(); ++k) {
    const ScatteringModel::Piece& piece = model.pieces()[k];
    const bool last = k + 1 == model.pieces().size();
    if (phi.hi + residual.largest() < piece.from || (!last && phi.lo - residual.largest() > piece.to))
      continue;
    for (const ScatteringModel::Term& t : piece.terms) {
      const Interval exponent =
          fit.near_normal ? t.slope * residual - t.curvature * square_difference
                          : residual * (t.slope - t.curvature * (phi + fit.offset_rad + fit.slope * psi));
      // The model has the factor e^(power fitted_log_ratio). ApparentScattering::log_remainder excludes the
      // squared ratio of the sines, hence power - 2.
      const Interval own = exponent + (t.power - 2) * log_ratio_here - t.power * fitted_log_ratio;
      remainder = remainder ? hull(*remainder, own) : own;
    }
  }
  // A model is a sum of positive terms, so the ratio of two models lies between the ratios of their terms.
  // Some piece contains the angle phi, so there is a remainder.
  ApparentScattering result{model.of_angle(fit.offset_rad, fit.slope, std::exp(fitted_log_ratio)), {}};
  result.log_remainder =
      *remainder + symmetric(change_at_breakpoints(model, phi, residual.largest()) + 1e-12);
  if (!result.log_remainder.is_finite()) return std::nullopt;
  return result;
}

std::vector<FacetScattering> facet_scattering(const EchoModel& model) {
  const auto textures = certified_textures(model);
  std::vector<FacetScattering> by_material;
  for (std::size_t material = 0; material < model.material_mu.size(); ++material) {
    FacetScattering own{model.scattering.empty() ? nullptr : model.scattering[material].get(),
                        model.material_mu[material]};
    if (own.model != nullptr) own.most = 1;
    if (textures[material] != nullptr) own.most *= textures[material]->range().hi();
    by_material.push_back(own);
  }
  return by_material;
}

double largest_cross_section(const ScatteringModel& model, const Interval& sine) {
  const Interval s = clamped_sine(sine), incidence = incidence_of(s);
  double most = 0;
  for (std::size_t k = 0; k < model.pieces().size(); ++k) {
    const ScatteringModel::Piece& piece = model.pieces()[k];
    const bool last = k + 1 == model.pieces().size();
    const double lo = std::max(incidence.lo, piece.from - angle_rounding),
                 hi = last ? incidence.hi : std::min(incidence.hi, piece.to + angle_rounding);
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
