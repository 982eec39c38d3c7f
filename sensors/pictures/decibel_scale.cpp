// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/pictures/decibel_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace tubefoot {

DecibelScale::DecibelScale(std::span<const double> energies_j, double display_gain_db) {
  std::vector<double> echoes;
  for (const double energy : energies_j)
    if (energy > 0 && std::isfinite(energy)) echoes.push_back(energy);
  if (echoes.empty()) return;
  const auto rank = static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(echoes.size() - 1) + 0.5);
  std::nth_element(echoes.begin(), echoes.begin() + rank, echoes.end());
  reference_j_ = echoes[static_cast<std::size_t>(rank)] * std::pow(10, -display_gain_db / 10);
}

double DecibelScale::level(double energy_j) const {
  if (!(energy_j > 0) || reference_j_ == 0) return 0;
  return std::clamp(1 + 10 * std::log10(energy_j / reference_j_) / range_db, 0.0, 1.0);
}

Colour DecibelScale::colour(double energy_j, double beyond) const {
  return mix(colour(energy_j), palette.beyond, beyond);
}

Colour DecibelScale::at_level(double level) {
  static constexpr std::array<Colour, 6> stops{{{0.020f, 0.016f, 0.024f},
                                                {0.190f, 0.105f, 0.075f},
                                                {0.440f, 0.240f, 0.115f},
                                                {0.700f, 0.420f, 0.180f},
                                                {0.910f, 0.665f, 0.370f},
                                                {1.000f, 0.950f, 0.820f}}};
  const double position = std::clamp(level, 0.0, 1.0) * (stops.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(position), stops.size() - 2);
  return mix(stops[below], stops[below + 1], position - static_cast<double>(below));
}

void DecibelScale::draw_legend(Canvas& canvas, int x, int y0, int y1) const {
  const int bar = 20, top = y0 + 2 * label_size, bottom = y1 - 2 * label_size;
  canvas.text(x, y0 + label_size / 2, "dB", label_size, palette.ink);
  canvas.fill(x - 1, top - 1, x + bar + 1, bottom + 1, palette.faint_ink);
  for (int y = top; y < bottom; ++y)
    canvas.fill(x, y, x + bar, y + 1, at_level(1 - (y - top + 0.5) / (bottom - top)));
  for (const double decibel : ticks(-range_db, 0, 10)) {
    const int y = top + static_cast<int>(std::lround(-decibel / range_db * (bottom - top - 1)));
    canvas.fill(x + bar + 1, y, x + bar + 6, y + 1, palette.faint_ink);
    canvas.label(x + bar + 11, y, tick_label(decibel, 10), label_size, palette.ink);
  }
  const int middle = y1 - label_size / 2;
  canvas.fill(x - 1, middle - 8, x + bar + 1, middle + 8, palette.faint_ink);
  canvas.fill(x, middle - 7, x + bar, middle + 7, palette.no_echo);
  canvas.label(x + bar + 11, middle, "no echo", label_size, palette.ink);
}

}  // namespace tubefoot
