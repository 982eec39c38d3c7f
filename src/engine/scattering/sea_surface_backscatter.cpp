// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/sea_surface_backscatter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

/// Returns the grazing angle [degrees] at which the cross-section of the wave facets is 15 dB below its value
/// at 90 degrees. The slope of a facet there is tan(incidence).
double crossover_deg(double slope_variance) {
  const double ratio = std::pow(10, -1.5);
  // sec^4 e^(-tan^2 / s^2) as a function of q = tan^2: (1 + q)^2 e^(-q / s^2). It decreases for s^2 <= 1/2.
  double lo = 0, hi = 1;
  const auto above = [&](double q) { return (1 + q) * (1 + q) * std::exp(-q / slope_variance) > ratio; };
  while (above(hi)) hi *= 2;
  for (int k = 0; k < 100; ++k) (above((lo + hi) / 2) ? lo : hi) = (lo + hi) / 2;
  return 90 - std::atan(std::sqrt(lo)) / degree;
}

}  // namespace

double SeaSurfaceCrossSections::roughness() const {
  return (share_of_facets * facets + (1 - share_of_facets) * small_scale) *
         std::pow(10, -bubble_loss_db / 10);
}

double sea_surface_slope_variance(double wind_speed_m_s) {
  return wind_speed_m_s < 1 ? 0.0034 : 4.6e-3 * std::log(2.1 * wind_speed_m_s * wind_speed_m_s);
}

SeaSurfaceCrossSections sea_surface_cross_sections(const SeaSurfaceBackscatter& sea, double grazing_rad) {
  const double wind = sea.wind_speed_m_s, frequency = sea.frequency_khz;
  if (!(wind > 0 && std::isfinite(wind)))
    throw std::invalid_argument("the scattering of the sea surface needs a wind speed above 0");
  if (!(frequency > 0 && std::isfinite(frequency)))
    throw std::invalid_argument("the scattering of the sea surface needs a frequency above 0");
  const double sine = std::sin(grazing_rad), cosine = std::max(std::cos(grazing_rad), 0.0),
               grazing_deg = grazing_rad / degree, all = sea_surface_slope_variance(wind),
               slope = std::max(all - sea.resolved_slope_variance, least_unresolved_slope * all),
               incidence_tangent = cosine / sine, by_frequency = std::pow(frequency, 0.85);
  SeaSurfaceCrossSections parts;
  parts.facets =
      std::exp(-incidence_tangent * incidence_tangent / slope) / (4 * pi * slope * std::pow(sine, 4));
  if (grazing_deg <= 85) parts.small_scale = 1.3e-5 * wind * std::pow(sine / cosine, 4);
  parts.share_of_facets = 1 / (1 + std::exp(0.524 * (crossover_deg(slope) - grazing_deg)));
  constexpr double breaking_m_s = 6;  // below this wind speed few waves break
  parts.bubble_loss_db = 1.26e-3 / sine * by_frequency * std::pow(std::max(wind, breaking_m_s), 1.57) *
                         std::exp(1.2 * std::min(wind - breaking_m_s, 0.0));
  constexpr double knee_m_s = 11, radiation_damping = 0.0136;
  const double total_damping = 2.55e-2 * std::cbrt(frequency),
               at_normal = std::pow(10, -5.2577 + 0.4701 * std::min(wind, knee_m_s)) *
                           std::pow(std::max(wind / knee_m_s, 1.0), 3.5) * by_frequency / std::pow(25, 0.85),
               beta = at_normal / sine;
  parts.bubbles = radiation_damping * at_normal / (4 * pi * total_damping) *
                  (8 * beta * std::exp(-2 * beta) - std::expm1(-4 * beta)) / (2 * beta);
  return parts;
}

ScatteringModel sea_surface_scattering(const SeaSurfaceBackscatter& sea) {
  // Between the rows of a table, the strength is linear in the angle. Rows are chosen from a fine grid so
  // that each step is as long as the tolerance permits.
  constexpr double step_deg = 0.25, tolerance_db = 0.03;
  constexpr int first = 4, last = 359;  // 1 to 89.75 degrees; constant above, so that the model is smooth
  std::vector<double> fine_db;
  for (int k = 0; k <= last; ++k)
    fine_db.push_back(k == 0
                          ? 0
                          : 10 * std::log10(std::max(
                                     sea_surface_cross_sections(sea, k * step_deg * degree).total(), 1e-30)));
  const auto is_linear = [&](int from, int to) {
    for (int k = from + 1; k < to; ++k) {
      const double part = double(k - from) / (to - from);
      if (std::abs((1 - part) * fine_db[std::size_t(from)] + part * fine_db[std::size_t(to)] -
                   fine_db[std::size_t(k)]) > tolerance_db)
        return false;
    }
    return true;
  };
  std::vector<double> grazing_deg, strength_db;
  for (int at = first;;) {
    grazing_deg.push_back(at * step_deg);
    strength_db.push_back(fine_db[std::size_t(at)]);
    if (at == last) break;
    int to = at + 1;
    while (to < last && is_linear(at, to + 1)) ++to;
    at = to;
  }
  return ScatteringModel::table(grazing_deg, strength_db);
}

}  // namespace tubefoot
