// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/scattering_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <stdexcept>

#include "geometry/numbers/scalars.hpp"

// Evaluates scattering models as sums of analytic terms, converts tables to such terms, and integrates the
// albedo by Gauss quadrature with seven nodes per panel.

namespace tubefoot {
namespace {

double from_db(double db) { return std::pow(10, db / 10); }

double power_of(double x, double exponent) {
  if (exponent == 0) return 1;
  if (exponent == 2) return x * x;
  if (exponent == 1) return x;
  return std::pow(x, exponent);
}

void refuse(const std::string& what) { throw std::invalid_argument(what); }

}  // namespace

ScatteringModel ScatteringModel::lambert(double mu) { return gsab({.oblique = mu, .oblique_exponent = 2}); }

ScatteringModel ScatteringModel::gsab(const Gsab& p) {
  for (const double level : {p.specular, p.oblique, p.transition})
    if (!(level >= 0 && std::isfinite(level)))
      refuse(fmt::format("the levels of a scattering model must be finite and 0 or more, not {}", level));
  for (const double width : {p.specular_width_rad, p.transition_width_rad})
    if (!(width > 0 && std::isfinite(width)))
      refuse(fmt::format("a lobe of a scattering model must have a width above 0, not {}", width));
  if (!(p.oblique_exponent >= 0 && std::isfinite(p.oblique_exponent)))
    refuse(fmt::format("the exponent of a scattering model must be 0 or more, not {}", p.oblique_exponent));
  Piece piece;
  const auto lobe = [&](double level, double width) {
    if (level > 0) piece.terms.push_back({level, 0, 1 / (2 * width * width), 0});
  };
  lobe(p.specular, p.specular_width_rad);
  if (p.oblique > 0) piece.terms.push_back({p.oblique, 0, 0, p.oblique_exponent});
  lobe(p.transition, p.transition_width_rad);
  if (piece.terms.empty()) refuse("a scattering model needs a level above 0");
  ScatteringModel model;
  model.pieces_.push_back(std::move(piece));
  return model;
}

ScatteringModel ScatteringModel::table(std::span<const double> grazing_deg,
                                       std::span<const double> strength_db) {
  const std::size_t n = grazing_deg.size();
  if (n == 0 || n != strength_db.size())
    refuse(fmt::format(
        "a backscatter table needs one level per angle, and at least one angle, not {} levels and {} angles",
        strength_db.size(), n));
  for (std::size_t k = 0; k < n; ++k) {
    if (!(grazing_deg[k] > (k > 0 ? grazing_deg[k - 1] : 0) && grazing_deg[k] <= 90))
      refuse(fmt::format(
          "the grazing angles of a table must increase, above 0 and at most 90 degrees, but angle {} is {}",
          k + 1, grazing_deg[k]));
    if (!(strength_db[k] >= -300 && strength_db[k] <= 100))
      refuse(fmt::format("the levels of a table must be from -300 to 100 dB, but level {} is {}", k + 1,
                         strength_db[k]));
  }
  const auto incidence = [&](std::size_t k) {
    return grazing_deg[k] == 90 ? 0 : (90 - grazing_deg[k]) * degree;
  };
  ScatteringModel model;
  double at = 0;
  const auto add = [&](double to, const Term& term) {
    if (to > at) model.pieces_.push_back({at, to, {term}});
    at = std::max(at, to);
  };
  add(incidence(n - 1), {from_db(strength_db[n - 1])});
  for (std::size_t k = n - 1; k-- > 0;) {
    const double to = incidence(k);
    if (!(to > at))
      refuse(
          fmt::format("the grazing angles {} and {} of a table are too close to each other", k + 1, k + 2));
    add(to, {from_db(strength_db[k + 1]),
             (strength_db[k] - strength_db[k + 1]) * std::numbers::ln10 / 10 / (to - at)});
  }
  const double sine = std::sin(grazing_deg[0] * degree);
  add(pi / 2, {from_db(strength_db[0]) / (sine * sine), 0, 0, 2});
  model.pieces_.back().to = pi / 2;
  return model;
}

ScatteringModel ScatteringModel::of_angle(double from_rad, double stretch, double sines) const {
  ScatteringModel model;
  for (const Piece& piece : pieces_) {
    const double to = (piece.to - from_rad) / stretch;
    const bool last = &piece == &pieces_.back() || to >= pi / 2;
    if (!last && !(to > 0)) continue;
    const double from = std::max((piece.from - from_rad) / stretch, 0.0), own = from_rad + stretch * from;
    Piece other{from, last ? pi / 2 : to, {}};
    for (const Term& t : piece.terms) {
      // The exponent at `from`, and its continuation.
      const double curvature = t.curvature * stretch * stretch;
      other.terms.push_back(
          {t.level * power_of(sines, t.power) *
               std::exp(t.slope * (own - piece.from) - t.curvature * own * own + curvature * from * from),
           stretch * (t.slope - 2 * t.curvature * own) + 2 * curvature * from, curvature, t.power});
    }
    model.pieces_.push_back(std::move(other));
    if (last) break;
  }
  return model;
}

double ScatteringModel::in_piece(const Piece& piece, double incidence_rad, double sine) {
  double sum = 0;
  for (const Term& t : piece.terms) {
    double value = t.level * power_of(sine, t.power);
    if (t.slope != 0 || t.curvature != 0)
      value *= std::exp(t.slope * (incidence_rad - piece.from) - t.curvature * incidence_rad * incidence_rad);
    sum += value;
  }
  return sum;
}

double ScatteringModel::cross_section(double sine, double cosine) const {
  const double incidence = std::atan2(cosine, sine);
  return in_piece(pieces_[piece_at(incidence)], incidence, sine);
}

double ScatteringModel::cross_section(double grazing_rad) const {
  const double incidence = pi / 2 - grazing_rad;
  return in_piece(pieces_[piece_at(incidence)], incidence, std::sin(grazing_rad));
}

std::size_t ScatteringModel::piece_at(double incidence_rad) const {
  const auto after =
      std::upper_bound(pieces_.begin(), pieces_.end(), incidence_rad,
                       [](double incidence, const Piece& piece) { return incidence < piece.to; });
  return std::min(std::size_t(after - pieces_.begin()), pieces_.size() - 1);
}

bool ScatteringModel::is_pointed() const {
  return std::any_of(pieces_.front().terms.begin(), pieces_.front().terms.end(),
                     [](const Term& t) { return t.slope != 0; });
}

double ScatteringModel::growth(double y) const {
  double most = 0;
  for (const Piece& piece : pieces_)
    for (const Term& t : piece.terms) most = std::max(most, std::abs(t.slope) * y + t.curvature * y * y);
  return most;
}

double ScatteringModel::largest_power() const {
  double most = 0;
  for (const Piece& piece : pieces_)
    for (const Term& t : piece.terms) most = std::max(most, t.power);
  return most;
}

double ScatteringModel::steepest_exponent() const {
  double most = 0;
  for (const Piece& piece : pieces_) {
    double own = 0;
    bool steady = false;
    for (const Term& t : piece.terms) {
      own = std::max(own, std::abs(t.slope) * (piece.to - piece.from) + t.curvature * piece.to * piece.to);
      steady = steady || (t.slope == 0 && t.curvature == 0);
    }
    // If a piece has a term without an exponent, terms that have decreased by e^-100 are negligible.
    most = std::max(most, steady ? std::min(own, 100.0) : own);
  }
  return most;
}

/// Returns Int sqrt(sigma(s)) dOmega_s over the half space, on panels of a quarter of a degree or less.
double ScatteringModel::half_albedo() const {
  double sum = 0;
  for (const Piece& piece : pieces_) {
    const int panels = int(std::ceil((piece.to - piece.from) / (0.25 * degree)));
    const double width = (piece.to - piece.from) / panels;
    for (int k = 0; k < panels; ++k)
      sum += boost::math::quadrature::gauss<double, 7>::integrate(
          [&](double phi) {
            const double sine = std::cos(phi);
            return 2 * pi * std::sin(phi) * std::sqrt(in_piece(piece, phi, sine));
          },
          piece.from + k * width, piece.from + (k + 1) * width);
  }
  return sum;
}

double ScatteringModel::albedo(double grazing_rad) const {
  return std::sqrt(cross_section(grazing_rad)) / std::sin(grazing_rad) * half_albedo();
}

ScatteringModel::Albedo ScatteringModel::largest_albedo() const {
  Albedo largest;
  const double scattered = half_albedo();
  const auto look = [&](double grazing) {
    const double value = std::sqrt(cross_section(grazing)) / std::sin(grazing) * scattered;
    if (value > largest.value * (1 + 1e-12)) largest = {grazing, value};
  };
  for (int k = 1; k <= 900; ++k) look(k * 0.1 * degree);
  for (const Piece& piece : pieces_)
    if (const double grazing = pi / 2 - piece.to; grazing > least_checked_deg * degree) look(grazing);
  return largest;
}

}  // namespace tubefoot
