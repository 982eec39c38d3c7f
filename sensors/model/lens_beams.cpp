// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/model/lens_beams.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "sensors/model/angles.hpp"

namespace tubefoot {

std::vector<double> lens_beam_centres(int beams) {
  struct Lens {
    double f, a3, a2, a1, a0;
  };
  if (beams != 48 && beams != 96)
    throw std::invalid_argument(
        fmt::format("lens positions are available for 48 or 96 beams, not for {}", beams));
  const Lens lens =
      beams == 48 ? Lens{1, 0.0015, -0.0036, 1.3351, 24.0976} : Lens{1.012, 0.0030, -0.0055, 2.6829, 48.04};
  std::vector<double> centres;
  double t = -14;
  for (int k = 1; k <= beams; ++k) {
    // Newton's method, from the previous beam: the cubic is increasing and nearly linear.
    for (int step = 0; step < 50; ++step) {
      const double off = lens.f * (((lens.a3 * t + lens.a2) * t + lens.a1) * t + lens.a0) + 1 - k;
      const double change = off / (lens.f * ((3 * lens.a3 * t + 2 * lens.a2) * t + lens.a1));
      t -= change;
      if (std::abs(change) < 1e-13) break;
    }
    centres.push_back(radians(t));
  }
  return centres;
}

std::vector<double> borders_between(const std::vector<double>& centres) {
  const std::size_t n = centres.size();
  std::vector<double> borders{centres[0] - (centres[1] - centres[0]) / 2};
  for (std::size_t k = 0; k + 1 < n; ++k) borders.push_back((centres[k] + centres[k + 1]) / 2);
  borders.push_back(centres[n - 1] + (centres[n - 1] - centres[n - 2]) / 2);
  return borders;
}

}  // namespace tubefoot
