// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/reference_parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tubefoot {

CertifiedEcho enclosed_echo(const Echo& ordinary, const std::vector<Ball>& total, double tolerance) {
  CertifiedEcho certified;
  certified.echo = ordinary;
  certified.bound.resize(total.size());
  for (std::size_t bin = 0; bin < total.size(); ++bin) {
    if (!total[bin].is_finite()) {
      certified.bound[bin] = std::numeric_limits<double>::infinity();
      continue;
    }
    const double energy = std::max(total[bin].middle(), 0.0);
    const Ball off = total[bin] - Ball(energy);
    certified.echo.energy[bin] = energy;
    certified.bound[bin] = std::max({off.hi(), -off.lo(), 0.0});
  }
  compare_with(certified, tolerance);
  return certified;
}

CertifiedEcho refined_until_tolerance(double tolerance,
                                      const std::function<CertifiedEcho(double, bool&)>& enclose) {
  constexpr int most_tries = 3;
  double working = tolerance;
  for (int tries = 1;; ++tries) {
    bool coarse = false;
    CertifiedEcho certified = enclose(working, coarse);
    const double excess = certified.worst_ratio;
    const bool bounded = std::ranges::all_of(certified.bound, [](double b) { return std::isfinite(b); });
    if (certified.bins_over == 0 || tries == most_tries || coarse || !bounded || !(excess < 1000))
      return certified;
    working /= 2 * excess;
  }
}

}  // namespace tubefoot
