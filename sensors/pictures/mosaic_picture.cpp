// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/pictures/mosaic_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/pictures/map_axes.hpp"

namespace tubefoot {
namespace {

constexpr int mosaic_header_height = 2 * page_margin + 34;
constexpr int smallest_side = 240, largest_side = 1400;

/// Mean power of the cells [c0, c1) x [r0, r1); NaN if no cell has a value.
double mean_power(const CellMeans& amplitudes, std::int64_t c0, std::int64_t c1, std::int64_t r0,
                  std::int64_t r1) {
  double sum = 0;
  int count = 0;
  for (std::int64_t row = r0; row < r1; ++row)
    for (std::int64_t column = c0; column < c1; ++column)
      if (const double value = amplitudes.mean(column, row); !std::isnan(value)) {
        sum += value * value;
        ++count;
      }
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

Canvas draw_mosaic(const CellMeans& amplitudes, double display_gain_db, const std::string& title,
                   const std::string& font) {
  const CellMeans::Extent& extent = amplitudes.extent();
  const double cell_m = amplitudes.cell_m();
  const double longest = static_cast<double>(std::max(extent.columns(), extent.rows()));
  const double shortest = static_cast<double>(std::min(extent.columns(), extent.rows()));
  // Large maps shrink to fit. Small ones grow up to the same limit.
  const double pixels_per_cell =
      std::min(largest_side / longest, std::max({1.0, smallest_side / shortest, 700 / longest}));
  const auto pixels = [&](std::int64_t cells) {
    return std::max(1, static_cast<int>(std::lround(static_cast<double>(cells) * pixels_per_cell)));
  };
  const int width = pixels(extent.columns()), height = pixels(extent.rows());
  const auto cell_at = [&](int pixel, std::int64_t cells) {
    return std::min(cells, static_cast<std::int64_t>(std::floor(pixel / pixels_per_cell + 1e-9)));
  };

  std::vector<double> power(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y)  // from the south
    for (int x = 0; x < width; ++x) {
      const std::int64_t c0 = std::min(cell_at(x, extent.columns()), extent.columns() - 1),
                         r0 = std::min(cell_at(y, extent.rows()), extent.rows() - 1);
      power[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
          mean_power(amplitudes, extent.west + c0,
                     extent.west + std::max(c0 + 1, cell_at(x + 1, extent.columns())), extent.south + r0,
                     extent.south + std::max(r0 + 1, cell_at(y + 1, extent.rows())));
    }
  std::vector<double> known;
  std::copy_if(power.begin(), power.end(), std::back_inserter(known),
               [](double value) { return !std::isnan(value); });
  const DecibelScale scale(known, display_gain_db);

  MapPlot map{0,
              mosaic_header_height,
              width,
              height,
              static_cast<double>(extent.west) * cell_m,
              static_cast<double>(extent.south) * cell_m,
              pixels_per_cell / cell_m};
  map.left = page_margin + map.northings_width(font);
  const int left = map.left, top = map.top, right = left + width, bottom = top + height;
  const int least_width = 2 * page_margin + text_width(title, title_size, font);
  Canvas canvas(std::max(least_width, right + 24 + DecibelScale::legend_width + page_margin),
                std::max(bottom, top + smallest_side) + axis_label_height + page_margin, palette.background,
                font);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double value =
          power[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
      if (!std::isnan(value)) canvas.blend(left + x, bottom - 1 - y, scale.colour(value));
    }

  canvas.fill(left - 1, top - 1, right + 1, top, palette.grid, 0.55);
  canvas.fill(left - 1, bottom, right + 1, bottom + 1, palette.grid, 0.55);
  canvas.fill(left - 1, top, left, bottom, palette.grid, 0.55);
  canvas.fill(right, top, right + 1, bottom, palette.grid, 0.55);
  canvas.text(page_margin, page_margin, title, title_size, palette.ink);
  scale.draw_legend(canvas, right + 24, top, std::max(top + smallest_side, std::min(bottom, top + 400)));
  map.draw_axes(canvas);
  return canvas;
}

}  // namespace tubefoot
