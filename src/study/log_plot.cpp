// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/log_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tubefoot {
namespace {

constexpr double width = 760, height = 520, left = 84, right = 206, top = 44, bottom = 62;

// Okabe & Ito's palette, which colour-blind readers tell apart; with a brown for its yellow, which is too
// faint on white.
constexpr std::array<const char*, 8> colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                             "#56b4e9", "#e69f00", "#000000", "#8c6d31"};

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

/// A logarithmic axis that ends at whole decades.
struct Axis {
  double lo = std::numeric_limits<double>::infinity(), hi = -std::numeric_limits<double>::infinity();
  double from = 0, to = 1;

  void hold(double value) {
    if (!(value > 0) || !std::isfinite(value)) return;
    lo = std::min(lo, std::log10(value));
    hi = std::max(hi, std::log10(value));
  }
  void settle() {
    if (!(lo <= hi)) lo = hi = 0;
    lo = std::floor(lo);
    hi = std::ceil(hi);
    if (hi - lo < 1) hi = lo + 1;
  }
  double at(double value) const { return from + (to - from) * (std::log10(value) - lo) / (hi - lo); }
  /// Decades between labels, so that they stay apart.
  int stride() const { return std::max(1, static_cast<int>(std::ceil((hi - lo) / 9))); }
};

std::string power(int exponent) {
  return fmt::format("10<tspan dy=\"-5\" font-size=\"9\">{}</tspan>", exponent);
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

std::string to_svg(const LogPlot& plot) {
  Axis x, y;
  for (const PlotSeries& series : plot.series)
    for (const auto& [px, py] : series.points) {
      if (!(px > 0)) continue;
      x.hold(px);
      y.hold(std::max(py, plot.floor));
    }
  y.hold(plot.floor);
  x.settle();
  y.settle();
  x.from = left, x.to = width - right;
  y.from = height - bottom, y.to = top;

  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"DejaVu Sans, sans-serif\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
      width, height);
  svg += text(left, 24, "start", escaped(plot.title), 15, " font-weight=\"bold\"");
  for (int d = static_cast<int>(x.lo); d <= static_cast<int>(x.hi); ++d) {
    const double at = x.at(std::pow(10.0, d));
    svg += line(at, y.from, at, y.to, "stroke=\"#dddddd\"");
    if ((d - static_cast<int>(x.lo)) % x.stride() == 0) svg += text(at, y.from + 20, "middle", power(d));
  }
  for (int d = static_cast<int>(y.lo); d <= static_cast<int>(y.hi); ++d) {
    const double at = y.at(std::pow(10.0, d));
    svg += line(x.from, at, x.to, at, "stroke=\"#dddddd\"");
    if ((d - static_cast<int>(y.lo)) % y.stride() == 0) svg += text(x.from - 8, at + 4, "end", power(d));
  }
  svg += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" "
      "stroke=\"#444444\"/>\n",
      x.from, y.to, x.to - x.from, y.from - y.to);
  svg += text((x.from + x.to) / 2, height - 16, "middle", escaped(plot.x_label));
  svg += text(20, (y.from + y.to) / 2, "middle", escaped(plot.y_label), 12,
              fmt::format(" transform=\"rotate(-90 20 {:.1f})\"", (y.from + y.to) / 2));
  if (plot.floor > 0) {
    const double at = y.at(plot.floor);
    svg += line(x.from, at, x.to, at, "stroke=\"#444444\" stroke-dasharray=\"6 4\"");
    svg += text(x.to - 6, at - 5, "end", escaped(plot.floor_name), 11, " fill=\"#444444\"");
  }

  double legend = top + 12;
  for (std::size_t s = 0; s < plot.series.size(); ++s) {
    const PlotSeries& series = plot.series[s];
    const std::string colour = colours[s % colours.size()];
    std::string path, dots;
    for (const auto& [px, py] : series.points) {
      const double value = std::max(py, plot.floor);
      if (!(px > 0) || !(value > 0)) continue;
      const double cx = x.at(px), cy = y.at(value);
      path += fmt::format("{}{:.1f},{:.1f}", path.empty() ? "" : " ", cx, cy);
      dots += fmt::format(
          "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\" stroke=\"{}\" "
          "stroke-width=\"1.5\"/>\n",
          cx, cy, py < plot.floor ? "white" : colour, colour);
    }
    if (series.joined && !path.empty())
      svg += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"/>\n", path,
                         colour);
    svg += dots;
    const double at = width - right + 14;
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\"/>\n", at + 4, legend - 4,
                       colour);
    svg += text(at + 14, legend, "start", escaped(series.name), 12);
    if (!series.note.empty()) {
      legend += 15;
      svg += text(at + 14, legend, "start", escaped(series.note), 11, " fill=\"#555555\"");
    }
    legend += 21;
  }
  return svg + "</svg>\n";
}

}  // namespace tubefoot
