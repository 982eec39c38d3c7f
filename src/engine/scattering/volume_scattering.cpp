// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/volume_scattering.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <stdexcept>

namespace tubefoot {

bool VolumeScattering::any() const {
  return std::ranges::any_of(s_v_per_m, [](double s_v) { return s_v > 0; });
}

void check(const VolumeScattering& volume) {
  if (volume.s_v_per_m.size() != volume.borders_m.size() + 1)
    throw std::invalid_argument(fmt::format("{} borders separate {} layers, but {} coefficients are given",
                                            volume.borders_m.size(), volume.borders_m.size() + 1,
                                            volume.s_v_per_m.size()));
  for (std::size_t k = 0; k < volume.borders_m.size(); ++k)
    if (!std::isfinite(volume.borders_m[k]) || (k > 0 && !(volume.borders_m[k] > volume.borders_m[k - 1])))
      throw std::invalid_argument(fmt::format(
          "borders of layers must be finite and increase; border {} is {} m", k, volume.borders_m[k]));
  for (const double s_v : volume.s_v_per_m)
    if (!(s_v >= 0 && std::isfinite(s_v)))
      throw std::invalid_argument(fmt::format(
          "a volume scattering coefficient must be finite and at least 0, not {} per metre", s_v));
}

double volume_spreading(double from_m, double to_m, double beta_per_m) {
  if (beta_per_m == 0) return (to_m - from_m) / (from_m * to_m);
  // The only singularity is at range 0. On panels this short, 15 Gauss-Legendre nodes are accurate to
  // rounding.
  using Rule = boost::math::quadrature::gauss<double, 15>;
  constexpr double widest = 0.25, strongest = 2;
  double sum = 0;
  for (double lo = from_m; lo < to_m;) {
    const double hi = std::min({to_m, lo * (1 + widest), lo + strongest / (2 * beta_per_m)});
    sum += Rule::integrate([&](double r) { return std::exp(-2 * beta_per_m * r) / (r * r); }, lo, hi);
    // The rest is at most e^(-2 beta hi) / hi.
    if (!(hi > lo) || std::exp(-2 * beta_per_m * hi) / hi < 1e-17 * sum) break;
    lo = hi;
  }
  return sum;
}

}  // namespace tubefoot
