// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/pictures/phase_colour.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "sensors/pictures/decibel_scale.hpp"

namespace tubefoot {

Colour phase_colour(double phase_rad, double brightness) {
  const auto component = [&](int k) {
    const double turn = phase_rad - k * 2 * std::numbers::pi / 3;
    return static_cast<float>(brightness * (0.5 + 0.45 * std::cos(turn)));
  };
  return {component(0), component(1), component(2)};
}

void draw_phase_legend(Canvas& canvas, int x, int y0, int y1) {
  const int bar = 20, top = y0 + 2 * label_size, bottom = y1 - 2 * label_size;
  canvas.text(x, y0 + label_size / 2, "phase", label_size, palette.ink);
  for (int y = top; y < bottom; ++y)
    canvas.fill(x, y, x + bar, y + 1,
                phase_colour(std::numbers::pi * (1 - 2 * (y - top + 0.5) / (bottom - top)), 1));
  for (const int degrees : {-180, -90, 0, 90, 180}) {
    const int y = top + (180 - degrees) * (bottom - top - 1) / 360;
    canvas.fill(x + bar + 1, y, x + bar + 6, y + 1, palette.faint_ink);
    canvas.label(x + bar + 11, y, fmt::format("{}\u00b0", degrees), label_size, palette.ink);
  }
}

}  // namespace tubefoot
