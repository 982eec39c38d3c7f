// SPDX-License-Identifier: GPL-3.0-or-later
// Draws diagrams with linear or logarithmic axes as SVG: axes with whole ticks, series with points and
// lines, and labels.
#include "study/diagram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

#include "files/shown.hpp"

namespace tubefoot {
namespace {

constexpr double width = 760, height = 520, left = 84, right = 224, top = 44, bottom = 62;

// Palette of Okabe and Ito, which colour-blind readers can distinguish, and four more colours. Brown replaces
// its yellow, which is too faint on white.
constexpr std::array<const char*, 12> colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                              "#56b4e9", "#e69f00", "#000000", "#8c6d31",
                                              "#5e3c99", "#8b1a2b", "#77ab00", "#7f7f7f"};

/// Dash patterns of lines. Their number and the number of markers have no common divisor, so that the
/// combination repeats later than the colours.
constexpr std::array<const char*, 4> dashes{"none", "7 3", "2 2.5", "8 3 2 3"};
constexpr std::size_t marker_count = 5;

/// Returns the marker of a series at a point: circle, square, diamond, or a triangle that points up or down.
std::string marker(std::size_t series, double x, double y, const std::string& fill,
                   const std::string& stroke) {
  const std::string style = fmt::format("fill=\"{}\" stroke=\"{}\" stroke-width=\"1.5\"/>\n", fill, stroke);
  const auto polygon = [&](std::initializer_list<std::pair<double, double>> corners) {
    std::string points;
    for (const auto& [dx, dy] : corners)
      points += fmt::format("{}{:.1f},{:.1f}", points.empty() ? "" : " ", x + dx, y + dy);
    return fmt::format("<polygon points=\"{}\" {}", points, style);
  };
  switch (series % marker_count) {
    case 0:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" {}", x, y, style);
    case 1:
      return polygon({{-3.6, -3.6}, {3.6, -3.6}, {3.6, 3.6}, {-3.6, 3.6}});
    case 2:
      return polygon({{0, -5.2}, {5.2, 0}, {0, 5.2}, {-5.2, 0}});
    case 3:
      return polygon({{0, -5}, {4.8, 3.6}, {-4.8, 3.6}});
    default:
      return polygon({{0, 5}, {4.8, -3.6}, {-4.8, -3.6}});
  }
}

/// An axis that ends at whole ticks: decades, or multiples of 1, 2 or 5 times a power of ten.
struct Axis {
  Scale scale = Scale::logarithmic;
  double lo = std::numeric_limits<double>::infinity(), hi = -std::numeric_limits<double>::infinity();
  double from = 0, to = 1, step = 1;

  bool shows(double value) const { return std::isfinite(value) && (scale == Scale::linear || value > 0); }
  double measure(double value) const { return scale == Scale::linear ? value : std::log10(value); }
  void hold(double value) {
    if (!shows(value)) return;
    lo = std::min(lo, measure(value));
    hi = std::max(hi, measure(value));
  }
  void settle() {
    if (!(lo <= hi)) lo = hi = 0;
    if (scale == Scale::linear) {
      const double rough = std::max(hi - lo, 1e-300) / 6,
                   power = std::pow(10.0, std::floor(std::log10(rough)));
      step = power * (rough > 5 * power ? 10 : rough > 2 * power ? 5 : rough > power ? 2 : 1);
    }
    lo = step * std::floor(lo / step);
    hi = step * std::ceil(hi / step);
    if (!(hi > lo)) hi = lo + step;
  }
  double at_measure(double measured) const { return from + (to - from) * (measured - lo) / (hi - lo); }
  double at(double value) const { return at_measure(measure(value)); }
  int ticks() const { return static_cast<int>(std::lround((hi - lo) / step)) + 1; }
  double tick(int k) const { return lo + k * step; }
  /// Number of ticks per label, so that labels do not overlap.
  int stride() const { return std::max(1, static_cast<int>(std::ceil((ticks() - 1) / 9.0))); }
};

std::string label(const Axis& axis, int tick) {
  const double at = axis.tick(tick);
  if (axis.scale == Scale::linear) return fmt::format("{:g}", std::abs(at) < axis.step / 2 ? 0.0 : at);
  return fmt::format("10<tspan dy=\"-5\" font-size=\"9\">{:g}</tspan>", at);
}

std::string text(double x, double y, const std::string& anchor, const std::string& inner, int size = 12,
                 const std::string& more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" font-size=\"{}\"{}>{}</text>\n", x,
                     y, anchor, size, more, inner);
}

std::string line(double x0, double y0, double x1, double y1, const std::string& style) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x0, y0, x1, y1,
                     style);
}

}  // namespace

const char* series_colour(std::size_t n) { return colours[n % colours.size()]; }

std::string to_svg(const Diagram& diagram) {
  Axis x, y;
  x.scale = y.scale = diagram.scale;
  const bool has_floor = diagram.scale == Scale::logarithmic && diagram.floor > 0;
  const auto raised = [&](double value) { return has_floor ? std::max(value, diagram.floor) : value; };
  for (const PlotSeries& series : diagram.series)
    for (const auto& [px, py] : series.points) {
      if (!x.shows(px)) continue;
      x.hold(px);
      y.hold(raised(py));
    }
  if (has_floor) y.hold(diagram.floor);
  x.settle();
  y.settle();
  x.from = left, x.to = width - right;
  y.from = height - bottom, y.to = top;

  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"DejaVu Sans, sans-serif\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
      width, height);
  svg += text(left, 24, "start", shown_markup(diagram.title), 15, " font-weight=\"bold\"");
  for (int k = 0; k < x.ticks(); ++k) {
    const double at = x.at_measure(x.tick(k));
    svg += line(at, y.from, at, y.to, "stroke=\"#dddddd\"");
    if (k % x.stride() == 0) svg += text(at, y.from + 20, "middle", label(x, k));
  }
  for (int k = 0; k < y.ticks(); ++k) {
    const double at = y.at_measure(y.tick(k));
    svg += line(x.from, at, x.to, at, "stroke=\"#dddddd\"");
    if (k % y.stride() == 0) svg += text(x.from - 8, at + 4, "end", label(y, k));
  }
  svg += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" "
      "stroke=\"#444444\"/>\n",
      x.from, y.to, x.to - x.from, y.from - y.to);
  svg += text((x.from + x.to) / 2, height - 16, "middle", shown_markup(diagram.x_label));
  svg += text(20, (y.from + y.to) / 2, "middle", shown_markup(diagram.y_label), 12,
              fmt::format(" transform=\"rotate(-90 20 {:.1f})\"", (y.from + y.to) / 2));
  if (has_floor) {
    const double at = y.at(diagram.floor);
    svg += line(x.from, at, x.to, at, "stroke=\"#444444\" stroke-dasharray=\"6 4\"");
    svg += text(x.to - 6, at - 5, "end", shown_markup(diagram.floor_name), 11, " fill=\"#444444\"");
  }

  double legend = top + 12;
  for (std::size_t s = 0; s < diagram.series.size(); ++s) {
    const PlotSeries& series = diagram.series[s];
    const std::string colour = series_colour(s);
    const std::string stroke = fmt::format("stroke=\"{}\" stroke-width=\"1.6\" stroke-dasharray=\"{}\" ",
                                           colour, dashes[s % dashes.size()]);
    // Dots would hide a joined line of many points.
    constexpr std::size_t most_dots = 100;
    const bool dotted = !series.joined || series.points.size() <= most_dots;
    std::string path, dots;
    for (const auto& [px, py] : series.points) {
      const double value = raised(py);
      if (!x.shows(px) || !y.shows(value)) continue;
      const double cx = x.at(px), cy = y.at(value);
      path += fmt::format("{}{:.1f},{:.1f}", path.empty() ? "" : " ", cx, cy);
      if (!dotted && !(py < value)) continue;
      dots += marker(s, cx, cy, py < value ? "white" : colour, colour);
    }
    if (series.joined && !path.empty())
      svg += fmt::format("<polyline points=\"{}\" fill=\"none\" {}/>\n", path, stroke);
    svg += dots;
    constexpr double sample_length = 26, name_gap = 8;
    const double at = width - right + 12, name_at = at + sample_length + name_gap;
    if (series.joined) svg += line(at, legend - 4, at + sample_length, legend - 4, stroke);
    if (dotted) svg += marker(s, at + sample_length / 2, legend - 4, colour, colour);
    svg += text(name_at, legend, "start", shown_markup(series.name), 12);
    if (!series.note.empty()) {
      legend += 15;
      svg += text(name_at, legend, "start", shown_markup(series.note), 11, " fill=\"#555555\"");
    }
    legend += 21;
  }
  return svg + "</svg>\n";
}

}  // namespace tubefoot
