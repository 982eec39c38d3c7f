// SPDX-License-Identifier: GPL-3.0-or-later
// Draws a page with one fan of echoes, its range and angle frame, its labels and the decibel scale. The
// steps of ranges and angles follow from the size of the fan.

#include "sensors/pictures/fan_page.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

constexpr int fan_header_height = 2 * page_margin + 44, footer_height = 44;
constexpr int angle_label_gap = 20, range_label_gap = 12, range_label_width = 60;

/// Step of the angle lines: a convenient divisor of a circle, at most eight parts, with labels at least 50
/// pixels apart.
double angle_step_deg(const CameraFan& fan) {
  const double extent_rad = fan.extent_rad();
  const double parts = std::clamp(std::floor(extent_rad * fan.far_m() * fan.pixels_per_m() / 50), 1.0, 8.0);
  for (const double step : {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0})
    if (degrees(extent_rad) <= parts * step) return step;
  return 45;
}

/// Step of the range arcs: at most six parts, with space for their labels along the starboard edge.
double range_step_m(const CameraFan& fan) {
  const double steepness = std::abs(std::cos(fan.last_azimuth_rad()));
  const double gap = steepness > 0.4 ? 26 / steepness : 65;  // labels below each other, or side by side
  const double extent_m = fan.far_m() - fan.near_m();
  return tick_step(extent_m,
                   static_cast<int>(std::clamp(std::floor(extent_m * fan.pixels_per_m() / gap), 1.0, 6.0)));
}

}  // namespace

FanPage::FanPage(CameraFan fan, Towards towards)
    : fan_(std::move(fan)), downwards_(towards == Towards::down), pixels_(fan_) {
  constexpr int around = CameraPixels::around;
  const double range_step = range_step_m(fan_), angle_step = radians(angle_step_deg(fan_));
  const int columns = fan_.width() + 2 * around, rows = fan_.height() + 2 * around;
  lines_.resize(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  tbb::parallel_for(0, rows, [&](int row) {
    CameraFan::Lines* line = &lines_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns)];
    for (int x = -around; x < fan_.width() + around; ++x)
      *line++ = fan_.lines_at(x + 0.5, row - around + 0.5, range_step, angle_step);
  });
}

/// Draws metres along the starboard edge and degrees along the far arc.
void FanPage::draw_labels(Canvas& canvas, int left, int top) const {
  const CameraFan& fan = fan_;
  const double range_step = range_step_m(fan), angle_step = angle_step_deg(fan);
  const double edge = fan.last_azimuth_rad();
  const bool level = std::abs(std::cos(edge)) <= 0.4;  // labels below the edge instead of beside it
  for (const double range : ticks(fan.near_m(), fan.far_m(), range_step)) {
    const double pixels = range * fan.pixels_per_m();
    const int x = left + static_cast<int>(std::lround(fan.x(edge, pixels))),
              y = top + row_of(static_cast<int>(std::lround(fan.y(edge, pixels))));
    canvas.label(level ? x : x + range_label_gap, level ? y + 22 : y + 5,
                 tick_label(range, range_step) + " m", label_size, palette.ink,
                 level ? Anchor::centre : Anchor::left);
  }
  const auto angles = ticks(degrees(fan.first_azimuth_rad()), degrees(fan.last_azimuth_rad()), angle_step);
  for (const double angle : angles) {
    // Straight astern has one label, +180, in a fan that contains both.
    if (angle < -180 + angle_step / 2 && angles.back() > 180 - angle_step / 2) continue;
    const double azimuth = radians(angle), pixels = fan.far_m() * fan.pixels_per_m() + angle_label_gap;
    canvas.label(left + static_cast<int>(std::lround(fan.x(azimuth, pixels))),
                 top + row_of(static_cast<int>(std::lround(fan.y(azimuth, pixels)))),
                 tick_label(angle, angle_step) + "\u00b0", label_size, palette.ink, Anchor::centre);
  }
}

Canvas FanPage::draw(const Texts& texts, const PingEchoes& echoes, const DecibelScale& scale,
                     const std::string& font) const {
  const CameraFan& fan = fan_;
  // The fan, its labels and the legend are side by side. Short fans leave space for the title.
  const int drawing_height = std::max(fan.height(), 200);  // space for the legend
  const int content = fan.width() + 2 * range_label_width + DecibelScale::legend_width;
  const int width = 2 * page_margin + std::max({content, text_width(texts.title, title_size, font),
                                                text_width(texts.subtitle, label_size, font),
                                                text_width(texts.footer, label_size, font)});
  const int fan_left = page_margin + range_label_width + (width - 2 * page_margin - content) / 2;
  Canvas canvas(width, fan_header_height + drawing_height + footer_height + page_margin, palette.background,
                font);

  constexpr int around = CameraPixels::around;
  FanColours colours(pixels_, echoes, scale);
  auto lines = lines_.begin();
  for (int y = -around; y < fan.height() + around; ++y)
    for (int x = -around; x < fan.width() + around; ++x, ++lines) {
      const FanColours::Pixel pixel = colours.at(x, y);
      const int column = fan_left + x, row = fan_header_height + row_of(y);
      if (pixel.coverage > 0) {
        canvas.blend(column, row, pixel.colour, pixel.coverage);
        if (lines->grid > 0) canvas.blend(column, row, palette.grid, 0.28 * lines->grid * pixel.coverage);
      }
      if (lines->outline > 0) canvas.blend(column, row, palette.grid, 0.55 * lines->outline);
    }

  canvas.text(page_margin, page_margin, texts.title, title_size, palette.ink);
  canvas.text(page_margin, page_margin + 30, texts.subtitle, label_size, palette.faint_ink);
  canvas.text(page_margin, canvas.height() - page_margin, texts.footer, label_size, palette.faint_ink);
  const int legend_bottom = fan_header_height + drawing_height;
  scale.draw_legend(canvas, width - page_margin - DecibelScale::legend_width + 20,
                    std::max(fan_header_height, legend_bottom - 400), legend_bottom);
  draw_labels(canvas, fan_left, fan_header_height);
  return canvas;
}

}  // namespace tubefoot
