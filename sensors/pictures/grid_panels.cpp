// SPDX-License-Identifier: GPL-3.0-or-later
// Draws a page of panels, each a uniform grid of values with axes and legend. Panels are side by side, or
// below each other if they are much wider than high.

#include "sensors/pictures/grid_panels.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/pictures/phase_colour.hpp"

namespace tubefoot {
namespace {

constexpr int panel_header_height = 2 * page_margin + 44, panel_axis_width = 76, panel_title_height = 58,
              footer_height = 34;

/// Pixels of a panel's drawing.
struct DrawingSize {
  int width = 0, height = 0;
};

DrawingSize size_of(const GridPanel& panel, int narrowest, int widest, int highest) {
  const int least = 240;
  if (!panel.equal_scales)
    return {std::clamp(static_cast<int>(std::min<std::size_t>(panel.columns, 1u << 20)), narrowest, widest),
            std::clamp(static_cast<int>(std::min<std::size_t>(panel.rows, 1u << 20)), std::min(420, highest),
                       highest)};
  const double across = std::abs(panel.across.last - panel.across.first),
               down = std::abs(panel.down.last - panel.down.first);
  const double scale = std::min(widest / across, highest / down);
  return {std::max(least / 2, static_cast<int>(std::lround(across * scale))),
          std::max(least / 2, static_cast<int>(std::lround(down * scale)))};
}

void draw_coherence_legend(Canvas& canvas, int x, int y0, int y1) {
  const int bar = 20, top = y0 + 2 * label_size, bottom = y1 - 2 * label_size;
  canvas.text(x, y0 + label_size / 2, "coherence", label_size, palette.ink);
  for (int y = top; y < bottom; ++y)
    canvas.fill(x, y, x + bar, y + 1, DecibelScale::at_level(1 - (y - top + 0.5) / (bottom - top)));
  for (const double value : ticks(0, 1, 0.2)) {
    const int y = top + static_cast<int>(std::lround((1 - value) * (bottom - top - 1)));
    canvas.fill(x + bar + 1, y, x + bar + 6, y + 1, palette.faint_ink);
    canvas.label(x + bar + 11, y, tick_label(value, 0.2), label_size, palette.ink);
  }
}

void draw_legend(Canvas& canvas, GridPanel::Legend legend, int x, int y0, int y1) {
  switch (legend) {
    case GridPanel::Legend::none:
      return;
    case GridPanel::Legend::decibels: {
      const double largest[] = {1.0};
      return DecibelScale(largest).draw_legend(canvas, x, y0, y1);
    }
    case GridPanel::Legend::phase:
      return draw_phase_legend(canvas, x, y0, y1);
    case GridPanel::Legend::coherence:
      return draw_coherence_legend(canvas, x, y0, y1);
  }
}

/// Position of a value between an axis's ends, 0 to 1. For an axis that counts items it is the middle of the
/// item.
double share_of(const GridPanel::Axis& axis, double value) {
  const double half = axis.counts ? 0.5 : 0.0;
  return (value + half - axis.first) / (axis.last - axis.first);
}

std::vector<double> labelled(const GridPanel::Axis& axis, double step) {
  const double low = std::min(axis.first, axis.last), high = std::max(axis.first, axis.last);
  return axis.counts ? ticks(low, high - 1, step) : ticks(low, high, step);
}

void draw(Canvas& canvas, const GridPanel& panel, int left, int top, DrawingSize size) {
  tbb::parallel_for(0, size.height, [&](int y) {
    const PixelSpan rows = items_under(y, size.height, panel.rows);
    for (int x = 0; x < size.width; ++x)
      canvas.blend(left + x, top + y, panel.colour(items_under(x, size.width, panel.columns), rows));
  });
  const int bottom = top + size.height;
  canvas.text(left, top - 34, panel.title, label_size, palette.ink);
  canvas.text(left + size.width / 2, bottom + 42, panel.across.title, label_size, palette.ink,
              Anchor::centre);
  canvas.text(left - 10, top - 12, panel.down.title, label_size, palette.ink, Anchor::right);
  const auto step_of = [](const GridPanel::Axis& axis, int wanted) {
    const double step = tick_step(std::abs(axis.last - axis.first), std::max(2, wanted));
    return axis.counts ? std::max(1.0, step) : step;
  };
  const double across_step = step_of(panel.across, size.width / 70),
               down_step = step_of(panel.down, size.height / 60);
  for (const double value : labelled(panel.across, across_step)) {
    const int x = left + std::min(size.width - 1,
                                  static_cast<int>(std::floor(share_of(panel.across, value) * size.width)));
    if (!panel.across.counts) canvas.fill(x, top, x + 1, bottom, palette.grid, 0.10);
    canvas.fill(x, bottom, x + 1, bottom + 6, palette.faint_ink);
    canvas.label(x, bottom + 18, tick_label(value, across_step), label_size, palette.ink, Anchor::centre);
  }
  for (const double value : labelled(panel.down, down_step)) {
    const int y = top + std::min(size.height - 1,
                                 static_cast<int>(std::floor(share_of(panel.down, value) * size.height)));
    if (!panel.down.counts) canvas.fill(left, y, left + size.width, y + 1, palette.grid, 0.10);
    canvas.fill(left - 6, y, left, y + 1, palette.faint_ink);
    canvas.label(left - 10, y, tick_label(value, down_step), label_size, palette.ink, Anchor::right);
  }
  for (const GridPanel::Mark& mark : panel.marks) {
    const int x = left + static_cast<int>(std::floor(share_of(panel.across, mark.across) * size.width)),
              y = top + static_cast<int>(std::floor(share_of(panel.down, mark.down) * size.height));
    canvas.fill(x - 1, y - 1, x + 2, y + 2, mark.colour);
  }
  draw_legend(canvas, panel.legend, left + size.width + page_margin, top, top + std::min(size.height, 400));
}

}  // namespace

Canvas draw_grid_page(const GridPage& page, const std::string& font) {
  if (page.panels.empty()) throw std::invalid_argument("the page has no drawings");
  for (const GridPanel& panel : page.panels)
    if (panel.columns == 0 || panel.rows == 0 || !panel.colour || panel.across.first == panel.across.last ||
        panel.down.first == panel.down.last)
      throw std::invalid_argument(
          fmt::format("the drawing '{}' has no cells, colours or extent", panel.title));
  const GridPanel& model = page.panels.front();
  const bool wide = model.equal_scales && std::abs(model.across.last - model.across.first) >
                                              1.6 * std::abs(model.down.last - model.down.first);
  const bool one = page.panels.size() == 1;
  std::vector<DrawingSize> sizes;
  for (const GridPanel& panel : page.panels)
    sizes.push_back(wide ? size_of(panel, 640, 1100, 520)
                         : size_of(panel, one ? 640 : 360, one ? 1000 : 560, 760));
  const auto outer_width = [&](DrawingSize size) {
    return panel_axis_width + size.width + page_margin + DecibelScale::legend_width;
  };
  const auto outer_height = [&](DrawingSize size) {
    return panel_title_height + size.height + axis_label_height;
  };
  int width = 0, height = 0;
  for (const DrawingSize size : sizes) {
    width = wide ? std::max(width, outer_width(size)) : width + outer_width(size);
    height = wide ? height + outer_height(size) : std::max(height, outer_height(size));
  }
  width = std::max({width, text_width(page.title, title_size, font),
                    widest_text({page.subtitle, page.footer}, label_size, font)});
  Canvas canvas(width + 2 * page_margin,
                panel_header_height - page_margin + height + footer_height + page_margin, palette.background,
                font);
  canvas.text(page_margin, page_margin, page.title, title_size, palette.ink);
  canvas.text(page_margin, page_margin + 30, page.subtitle, label_size, palette.faint_ink);
  canvas.text(page_margin, canvas.height() - page_margin, page.footer, label_size, palette.faint_ink);
  int left = page_margin + panel_axis_width, top = panel_header_height - page_margin + panel_title_height;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    draw(canvas, page.panels[k], left, top, sizes[k]);
    (wide ? top : left) += wide ? outer_height(sizes[k]) : outer_width(sizes[k]);
  }
  return canvas;
}

}  // namespace tubefoot
