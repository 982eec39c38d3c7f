// SPDX-License-Identifier: GPL-3.0-or-later
#include "exchange/stonefish_beams.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "exchange/plain_number.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot {

int stonefish_views(double width_deg) {
  constexpr float widest_view_deg = 20;
  return static_cast<int>(std::ceil(static_cast<float>(width_deg) / widest_view_deg));
}

std::vector<double> stonefish_beam_angles_deg(int beams, double width_deg) {
  if (beams < 2 || !(width_deg > 0) || width_deg > 360) return {};
  const int views = stonefish_views(width_deg);
  const int first = static_cast<int>(std::round(static_cast<float>(beams) / static_cast<float>(views))),
            last = beams - first * (views - 1), most = std::max(first, last);
  const double view_deg = width_deg * most / beams;
  if (last < 0 || view_deg >= 180) return {};
  const double half = std::tan(radians(view_deg) / 2);
  std::vector<double> angles;
  for (int view = 0; view < views; ++view) {
    const double middle_deg = width_deg * first * view / beams - width_deg / 2 + view_deg / 2;
    for (int beam = 0; beam < (view + 1 < views ? first : last); ++beam)
      angles.push_back(
          plain(middle_deg + degrees(std::atan(half * ((2.0 * beam + 1) / most - 1))), width_deg));
  }
  if (std::ranges::adjacent_find(angles, std::greater_equal()) != angles.end()) return {};
  return angles;
}

}  // namespace tubefoot
