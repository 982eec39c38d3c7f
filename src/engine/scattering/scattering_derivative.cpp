// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/scattering_derivative.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "geometry/numbers/scalars.hpp"

// Every term is level e^(slope (phi - from) - curvature phi^2) sine^power. Its derivatives are products of
// the term and of low polynomials of phi and of log(sine).

namespace tubefoot {
namespace {

constexpr double neper_per_db = std::numbers::ln10 / 10;

double value_of(const ScatteringModel::Term& t, double from, double incidence, double sine) {
  return t.level * std::exp(t.slope * (incidence - from) - t.curvature * incidence * incidence) *
         std::pow(sine, t.power);
}

}  // namespace

CrossSectionSlopes slopes_of(const ScatteringModel& model, double sine, double cosine) {
  const double incidence = std::atan2(cosine, sine);
  const ScatteringModel::Piece& piece = model.pieces()[model.piece_at(incidence)];
  CrossSectionSlopes sum;
  for (const ScatteringModel::Term& t : piece.terms) {
    const double value = value_of(t, piece.from, incidence, sine);
    sum.value += value;
    sum.by_log_sine += t.power * value;
    sum.by_incidence += (t.slope - 2 * t.curvature * incidence) * value;
  }
  return sum;
}

ScatteringDerivative ScatteringDerivative::gsab(const ScatteringModel::Gsab& parameters, Gsab which) {
  ScatteringModel::gsab(parameters);  // checks the parameters
  // The model of the one term that contains the parameter. A level of 0 has a derivative too.
  ScatteringModel::Gsab own{0, parameters.specular_width_rad,  0, parameters.oblique_exponent,
                            0, parameters.transition_width_rad};
  Factor factor;
  double level = 1;
  const auto lobe = [&](double peak, double width, bool by_level) {
    level = by_level ? 1 : peak;
    if (by_level)
      factor.constant = 1;
    else
      factor.square = 1 / (width * width * width);
  };
  switch (which) {
    case Gsab::specular:
    case Gsab::specular_width_rad:
      lobe(parameters.specular, parameters.specular_width_rad, which == Gsab::specular);
      own.specular = 1;
      break;
    case Gsab::transition:
    case Gsab::transition_width_rad:
      lobe(parameters.transition, parameters.transition_width_rad, which == Gsab::transition);
      own.transition = 1;
      break;
    case Gsab::oblique:
      own.oblique = factor.constant = 1;
      break;
    case Gsab::oblique_exponent:
      own.oblique = factor.log = 1;
      level = parameters.oblique;
      break;
  }
  for (double* part : {&factor.constant, &factor.square, &factor.log}) *part *= level;
  ScatteringDerivative derivative;
  derivative.model_ = ScatteringModel::gsab(own);
  derivative.factors_ = {{factor}};
  return derivative;
}

// Between two angles, the logarithm of the cross-section is linear in phi. With the share s of the interval,
// its derivatives by both levels are 1 - s and s. Those by both angles are -slope times these.
ScatteringDerivative ScatteringDerivative::table(std::span<const double> grazing_deg,
                                                 std::span<const double> strength_db, std::size_t which,
                                                 bool by_angle) {
  ScatteringDerivative derivative;
  derivative.model_ = ScatteringModel::table(grazing_deg, strength_db);
  if (which >= grazing_deg.size())
    throw std::invalid_argument(
        fmt::format("a backscatter table of {} angles has no angle {}", grazing_deg.size(), which));
  const double incidence = std::max((90 - grazing_deg[which]) * degree, 0.0);
  const auto& pieces = derivative.model_.pieces();
  const auto is_at = [&](double border) { return std::abs(border - incidence) < 1e-12; };
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    Factor factor;
    const ScatteringModel::Piece& piece = pieces[p];
    const ScatteringModel::Term& term = piece.terms.front();
    const bool tail = p + 1 == pieces.size(), top = p == 0 && grazing_deg.back() < 90;
    // Per unit of the level's logarithm, and per radian of incidence.
    if (tail && which == 0) {
      const double grazing = grazing_deg[0] * degree;
      factor.constant = by_angle ? 2 * std::cos(grazing) / std::sin(grazing) : 1;
    } else if (!tail && (is_at(piece.from) || is_at(piece.to))) {
      const double length = piece.to - piece.from, scale = by_angle ? -term.slope : 1;
      if (top)
        factor.constant = by_angle || !is_at(piece.to) ? 0 : 1;
      else if (is_at(piece.from))
        factor = {scale, -scale / length, 0, 0};
      else
        factor.linear = scale / length;
    }
    const double unit = by_angle ? -degree : neper_per_db;
    derivative.factors_.push_back({{unit * factor.constant, unit * factor.linear, 0, 0}});
  }
  return derivative;
}

ScatteringDerivative ScatteringDerivative::table_strength(std::span<const double> grazing_deg,
                                                          std::span<const double> strength_db,
                                                          std::size_t which) {
  return table(grazing_deg, strength_db, which, false);
}

ScatteringDerivative ScatteringDerivative::table_angle(std::span<const double> grazing_deg,
                                                       std::span<const double> strength_db,
                                                       std::size_t which) {
  return table(grazing_deg, strength_db, which, true);
}

ScatteringDerivative ScatteringDerivative::scaled(double scale) const {
  ScatteringDerivative derivative = *this;
  for (std::vector<Factor>& of_piece : derivative.factors_)
    for (Factor& factor : of_piece)
      for (double* part : {&factor.constant, &factor.linear, &factor.square, &factor.log}) *part *= scale;
  return derivative;
}

double ScatteringDerivative::cross_section(double sine, double cosine) const {
  const double incidence = std::atan2(cosine, sine);
  const std::size_t p = model_.piece_at(incidence);
  const ScatteringModel::Piece& piece = model_.pieces()[p];
  double sum = 0;
  for (std::size_t k = 0; k < piece.terms.size(); ++k) {
    const Factor& factor = factors_[p][k];
    const double by = factor.constant + factor.linear * (incidence - piece.from) +
                      factor.square * incidence * incidence +
                      (factor.log != 0 ? factor.log * std::log(sine) : 0);
    if (by != 0) sum += by * value_of(piece.terms[k], piece.from, incidence, sine);
  }
  return sum;
}

}  // namespace tubefoot
