// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/pictures/map_axes.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sensors/pictures/decibel_scale.hpp"

namespace tubefoot {
namespace {

constexpr int tick_width = 14;

}  // namespace

double MapPlot::step_m() const { return tick_step(std::max(width, height) / pixels_per_m, 8); }

int MapPlot::northings_width(const std::string& font) const {
  std::vector<std::string> labels{upward_title};
  for (const double north : ticks(south_m, south_m + height / pixels_per_m, step_m()))
    labels.push_back(tick_label(north, step_m()));
  return widest_text(labels, label_size, font) + tick_width;
}

void MapPlot::draw_axes(Canvas& canvas) const {
  const int right = left + width, bottom = top + height;
  canvas.text(left, bottom + 44, across_title, label_size, palette.ink);
  canvas.text(left - 12, top - 22, upward_title, label_size, palette.ink, Anchor::right);
  const double step = step_m();
  for (const double east : ticks(west_m, west_m + width / pixels_per_m, step)) {
    const int x = std::min(right, left + static_cast<int>(std::lround((east - west_m) * pixels_per_m)));
    canvas.fill(x, bottom + 1, x + 1, bottom + 7, palette.faint_ink);
    canvas.label(x, bottom + 20, tick_label(east, step), label_size, palette.ink, Anchor::centre);
  }
  for (const double north : ticks(south_m, south_m + height / pixels_per_m, step)) {
    const int y = bottom - 1 - static_cast<int>(std::lround((north - south_m) * pixels_per_m));
    canvas.fill(left - 7, y, left - 1, y + 1, palette.faint_ink);
    canvas.label(left - 12, y, tick_label(north, step), label_size, palette.ink, Anchor::right);
  }
}

}  // namespace tubefoot
