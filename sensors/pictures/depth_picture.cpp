// SPDX-License-Identifier: GPL-3.0-or-later
// Draws the mean depths of soundings as a shaded relief, coloured by depth, with axes, scale and legend. The
// light comes from the north-west, 45 degrees high; slopes are central differences. Cells without soundings
// keep the background.

#include "sensors/pictures/depth_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "sensors/model/angles.hpp"
#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/pictures/map_axes.hpp"

namespace tubefoot {
namespace {

constexpr int depth_header_height = 2 * page_margin + 52, legend_width = 180;
constexpr int longest_side = 900, shortest_side = 320;

/// Colour of a point in the perceptually uniform space OKLab (B. Ottosson, 2020), in sRGB.
Colour from_oklab(double lightness, double a, double b) {
  const auto cube = [](double x) { return x * x * x; };
  const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b),
               m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b),
               s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
  const auto coded = [](double linear) {
    const double x = std::clamp(linear, 0.0, 1.0);
    return static_cast<float>(x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055);
  };
  return {coded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          coded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          coded(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

/// Colours from shallow to deep: pale yellow, green, blue, dark blue. Equal steps of depth are equal steps of
/// lightness and of hue, so that the map has no visible bands and stays readable in grey.
Colour depth_colour(double part) {
  constexpr std::size_t count = 1024;
  static const std::array<Colour, count> colours = [] {
    std::array<Colour, count> values;
    for (std::size_t k = 0; k < count; ++k) {
      const double at = static_cast<double>(k) / (count - 1), hue = radians(100 + 175 * at), chroma = 0.1;
      values[k] = from_oklab(0.93 - 0.6 * at, chroma * std::cos(hue), chroma * std::sin(hue));
    }
    return values;
  }();
  return colours[static_cast<std::size_t>(std::lround(std::clamp(part, 0.0, 1.0) * (count - 1)))];
}

/// Range of the drawn depths: the extremes of the cells.
struct DepthRange {
  double shallow = std::numeric_limits<double>::infinity(), deep = -shallow;
  double part(double depth) const { return deep > shallow ? (depth - shallow) / (deep - shallow) : 0.5; }
};

DepthRange range_of(const CellMeans& cells) {
  DepthRange range;
  const CellMeans::Extent& e = cells.extent();
  for (std::int64_t row = e.south; row < e.north; ++row)
    for (std::int64_t column = e.west; column < e.east; ++column) {
      const double depth = cells.mean(column, row);
      if (std::isnan(depth)) continue;
      range.shallow = std::min(range.shallow, depth);
      range.deep = std::max(range.deep, depth);
    }
  return range;
}

/// Shade of a cell under a light from the north-west, 45 degrees high; 1 on a level seabed. Slopes are
/// central differences, or one-sided ones at the rim.
double shade(const CellMeans& cells, std::int64_t column, std::int64_t row) {
  const double here = cells.mean(column, row);
  const auto slope = [&](std::int64_t dx, std::int64_t dy) {  // of the height
    const double before = cells.mean(column - dx, row - dy), after = cells.mean(column + dx, row + dy);
    const double first = std::isnan(before) ? here : before, last = std::isnan(after) ? here : after;
    const int steps = (std::isnan(before) ? 0 : 1) + (std::isnan(after) ? 0 : 1);
    return steps == 0 ? 0 : -(last - first) / (steps * cells.cell_m());
  };
  const double east = slope(1, 0), north = slope(0, 1);
  const double lit = (east * 0.5 - north * 0.5 + std::sqrt(0.5)) / std::sqrt(1 + east * east + north * north);
  return std::clamp(lit / std::sqrt(0.5), 0.0, 1.4);
}

Colour lit_colour(Colour colour, double shade) {
  constexpr Colour black{0, 0, 0}, white{1, 1, 1};
  return shade < 1 ? mix(black, colour, 0.25 + 0.75 * shade) : mix(colour, white, 0.8 * (shade - 1));
}

}  // namespace

Canvas draw_depths(const CellMeans& depths, const std::string& title, const std::string& font) {
  if (depths.empty()) throw std::runtime_error("there are no soundings to draw");
  const CellMeans::Extent& extent = depths.extent();
  const double cell = depths.cell_m();
  const double longest = static_cast<double>(std::max(extent.columns(), extent.rows()));
  const double pixels_per_cell = longest_side / longest;
  const auto pixels = [&](std::int64_t cells) {
    return std::max(1, static_cast<int>(std::lround(static_cast<double>(cells) * pixels_per_cell)));
  };
  const int width = pixels(extent.columns()), height = pixels(extent.rows());
  MapPlot map{0,
              depth_header_height,
              width,
              height,
              static_cast<double>(extent.west) * cell,
              static_cast<double>(extent.south) * cell,
              pixels_per_cell / cell};
  map.left = page_margin + map.northings_width(font);
  const int left = map.left, top = map.top;
  const int page_width = std::max(width, shortest_side), page_height = std::max(height, shortest_side);
  const DepthRange range = range_of(depths);
  const std::string subtitle =
      fmt::format("mean depth of soundings in cells of {:g} m, {:.2f} to {:.2f} m; lit from the north-west",
                  cell, range.shallow, range.deep);
  Canvas canvas(page_margin + std::max({left + page_width + legend_width,
                                        page_margin + text_width(title, title_size, font),
                                        page_margin + text_width(subtitle, label_size, font)}),
                top + page_height + axis_label_height + page_margin, palette.background, font);

  // On large grids each pixel shows the cell under its middle.
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::int64_t column = extent.west + static_cast<std::int64_t>((x + 0.5) / pixels_per_cell);
      const std::int64_t row = extent.north - 1 - static_cast<std::int64_t>((y + 0.5) / pixels_per_cell);
      const double depth = depths.mean(column, row);
      if (std::isnan(depth)) continue;
      canvas.blend(left + x, top + y,
                   lit_colour(depth_colour(range.part(depth)), shade(depths, column, row)));
    }

  const int right = left + width, bottom = top + height;
  canvas.fill(left - 1, top - 1, right + 1, top, palette.grid, 0.55);
  canvas.fill(left - 1, bottom, right + 1, bottom + 1, palette.grid, 0.55);
  canvas.fill(left - 1, top, left, bottom, palette.grid, 0.55);
  canvas.fill(right, top, right + 1, bottom, palette.grid, 0.55);
  canvas.text(page_margin, page_margin, title, title_size, palette.ink);
  canvas.text(page_margin, page_margin + 30, subtitle, label_size, palette.faint_ink);
  map.draw_axes(canvas);

  constexpr int bar_width = 22, bar_height = 260;
  const int bar_x = left + page_width + 34, bar_top = top + 24;
  for (int y = 0; y < bar_height; ++y)
    canvas.fill(bar_x, bar_top + y, bar_x + bar_width, bar_top + y + 1, depth_colour((y + 0.5) / bar_height));
  canvas.text(bar_x, top, "depth (m)", label_size, palette.ink);
  const double span = range.deep - range.shallow;
  const double depth_step = span > 0 ? tick_step(span, 6) : 1;
  for (const double depth :
       span > 0 ? ticks(range.shallow, range.deep, depth_step) : std::vector<double>{range.shallow}) {
    const int y = bar_top + static_cast<int>(std::lround(range.part(depth) * bar_height));
    canvas.fill(bar_x + bar_width, y, bar_x + bar_width + 6, y + 1, palette.faint_ink);
    canvas.label(bar_x + bar_width + 12, y,
                 span > 0 ? tick_label(depth, depth_step) : fmt::format("{:.2f}", depth), label_size,
                 palette.ink);
  }

  constexpr double longest_scale = 110;  // in pixels
  const double scale_m = tick_step(longest_scale / map.pixels_per_m, 3);
  const int scale_pixels = static_cast<int>(std::lround(scale_m * map.pixels_per_m));
  const int scale_y = bar_top + bar_height + 34;
  canvas.fill(bar_x, scale_y, bar_x + scale_pixels, scale_y + 3, palette.ink);
  canvas.text(bar_x, scale_y + 20, fmt::format("{:g} m", scale_m), label_size, palette.ink);

  const int swatch_y = scale_y + 50;
  canvas.fill(bar_x - 1, swatch_y - 8, bar_x + bar_width + 1, swatch_y + 8, palette.faint_ink);
  canvas.fill(bar_x, swatch_y - 7, bar_x + bar_width, swatch_y + 7, palette.background);
  canvas.text(bar_x + bar_width + 12, swatch_y, "no sounding", label_size, palette.ink);
  return canvas;
}

}  // namespace tubefoot
