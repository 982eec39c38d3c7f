// SPDX-License-Identifier: GPL-3.0-or-later
// Draws a table of target strengths as lines over an angle or frequency, or as a map over two axes. It
// shows the 60 dB below the strongest value.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/signal/target_strength.hpp"
#include "sensors/pictures/canvas.hpp"
#include "sensors/pictures/decibel_scale.hpp"
#include "strength/strength_output.hpp"
#include "study/diagram.hpp"
#include "study/svg_png.hpp"

namespace tubefoot {
namespace {

constexpr double shown_db = 60;  // range of levels below the strongest
constexpr double clip_db = 10;   // of shown differences: nulls of a pattern differ by any amount
constexpr std::size_t most_lines = 5;
constexpr std::size_t diagram_width = 760, diagram_height = 520;  // of to_svg()

struct Axis {
  std::string name;
  std::vector<double> values;
};

std::string in_words(double hertz) {
  return hertz >= 1e6 ? fmt::format("{:g} MHz", hertz / 1e6) : fmt::format("{:g} kHz", hertz / 1e3);
}

std::string title_of(const StrengthTable& table) {
  return fmt::format("Target strength of {}, {}", table.mesh_name, table.request.surface_name);
}

/// The three axes of the table, longest first, and the target strength by their indices.
class Cube {
 public:
  explicit Cube(const StrengthTable& table) : table_(table) {
    const StrengthRequest& r = table.request;
    axes_ = {Axis{"azimuth (degrees)", r.azimuths_deg}, Axis{"elevation (degrees)", r.elevations_deg},
             Axis{"frequency (kHz)", {}}};
    for (const double hertz : r.frequencies_hz) axes_[2].values.push_back(hertz / 1e3);
    std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
      return axes_[a].values.size() > axes_[b].values.size();
    });
    for (const std::complex<double>& length : table.length_m)
      strongest_ = std::max(strongest_, target_strength_db(length));
    if (!std::isfinite(strongest_)) strongest_ = 0;
  }
  const Axis& axis(std::size_t rank) const { return axes_[order_[rank]]; }
  bool is_frequency(std::size_t rank) const { return order_[rank] == 2; }
  double strongest() const { return strongest_; }
  double db(std::size_t first, std::size_t second, std::size_t third) const {
    const auto [azimuth, elevation, frequency] = place(first, second, third);
    return target_strength_db(table_.at(elevation, azimuth, frequency));
  }
  /// Target strength of the comparison; NaN if it has none.
  double compared_db(std::size_t first, std::size_t second, std::size_t third) const {
    const auto [azimuth, elevation, frequency] = place(first, second, third);
    return table_.comparison->strength_db[table_.index(elevation, azimuth, frequency)];
  }
  std::string named(std::size_t rank, std::size_t k) const {
    const double value = axis(rank).values[k];
    if (is_frequency(rank)) return in_words(1e3 * value);
    return fmt::format("{} {:g} deg", order_[rank] == 0 ? "azimuth" : "elevation", value);
  }

 private:
  /// Indices of azimuth, elevation and frequency.
  std::array<std::size_t, 3> place(std::size_t first, std::size_t second, std::size_t third) const {
    std::array<std::size_t, 3> at{};
    at[order_[0]] = first;
    at[order_[1]] = second;
    at[order_[2]] = third;
    return at;
  }

  const StrengthTable& table_;
  std::array<Axis, 3> axes_;
  std::array<std::size_t, 3> order_{0, 1, 2};
  double strongest_ = -std::numeric_limits<double>::infinity();
};

void write_lines(const StrengthTable& table, const Cube& cube, const std::filesystem::path& file) {
  Diagram diagram{
      title_of(table), cube.axis(0).name, "target strength (dB re 1 m2)", {}, Scale::linear, 0, ""};
  if (cube.axis(2).values.size() == 1) diagram.title += ", " + cube.named(2, 0);
  for (std::size_t line = 0; line < cube.axis(1).values.size(); ++line) {
    PlotSeries series{cube.named(1, line), "", {}, true};
    for (std::size_t k = 0; k < cube.axis(0).values.size(); ++k)
      series.points.emplace_back(cube.axis(0).values[k],
                                 std::max(cube.db(k, line, 0), cube.strongest() - shown_db));
    diagram.series.push_back(std::move(series));
  }
  write_png_of_svg(to_svg(diagram), file);
}

/// Draws both target strengths of one line of the table.
Diagram both_strengths(const StrengthTable& table, const Cube& cube, std::size_t line) {
  const std::string third = cube.is_frequency(1) ? "" : ", " + cube.named(2, 0);
  Diagram diagram{title_of(table) + ", " + cube.named(1, line) + third,
                  cube.axis(0).name,
                  "target strength (dB re 1 m2)",
                  {{"tubefoot", "", {}, true}, {table.comparison->name, "", {}, true}},
                  Scale::linear,
                  0,
                  ""};
  for (std::size_t k = 0; k < cube.axis(0).values.size(); ++k) {
    const double at = cube.axis(0).values[k], weakest = cube.strongest() - shown_db,
                 other = cube.compared_db(k, line, 0);
    diagram.series[0].points.emplace_back(at, std::max(cube.db(k, line, 0), weakest));
    if (!std::isnan(other)) diagram.series[1].points.emplace_back(at, std::max(other, weakest));
  }
  return diagram;
}

/// Draws the difference of one line of the table from the comparison.
Diagram strength_difference(const StrengthTable& table, const Cube& cube, std::size_t line) {
  Diagram diagram{fmt::format("tubefoot minus {}, clipped at {:g} dB", table.comparison->name, clip_db),
                  cube.axis(0).name,
                  "difference (dB)",
                  {{"difference", "", {}, true}, {"no difference", "", {}, true}},
                  Scale::linear,
                  0,
                  ""};
  for (std::size_t k = 0; k < cube.axis(0).values.size(); ++k) {
    const double at = cube.axis(0).values[k], other = cube.compared_db(k, line, 0);
    if (!std::isnan(other))
      diagram.series[0].points.emplace_back(at, std::clamp(cube.db(k, line, 0) - other, -clip_db, clip_db));
    diagram.series[1].points.emplace_back(at, 0);
  }
  return diagram;
}

/// Draws a row per line of the table: both target strengths, and next to them their difference.
void write_compared_lines(const StrengthTable& table, const Cube& cube, const std::filesystem::path& file) {
  const std::size_t rows = cube.axis(1).values.size();
  std::string panels;
  for (std::size_t line = 0; line < rows; ++line)
    for (const auto& [diagram, x] : {std::pair(both_strengths(table, cube, line), std::size_t{0}),
                                     std::pair(strength_difference(table, cube, line), diagram_width)})
      panels += fmt::format("<svg x=\"{}\" y=\"{}\"{}", x, line * diagram_height, to_svg(diagram).substr(4));
  write_png_of_svg(
      fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\">\n{}</svg>\n",
                  2 * diagram_width, rows * diagram_height, panels),
      file);
}

/// Returns the index of the axis value nearest to a fraction of the axis.
std::size_t nearest(const std::vector<double>& values, double part) {
  const double value = values.front() + part * (values.back() - values.front());
  const auto above = std::lower_bound(values.begin(), values.end(), value);
  if (above == values.end()) return values.size() - 1;
  const auto k = static_cast<std::size_t>(above - values.begin());
  return k > 0 && value - values[k - 1] < values[k] - value ? k - 1 : k;
}

void write_map(const StrengthTable& table, const Cube& cube, const std::filesystem::path& file) {
  constexpr int left = 110, top = 112, width = 900, height = 480, bar = 24;
  Canvas canvas(left + width + 170, top + height + 90, palette.background, label_font());
  canvas.text(28, 34, title_of(table), title_size, palette.ink);
  const std::string third =
      cube.axis(2).values.size() > 1
          ? fmt::format("{}, first of {}; ", cube.named(2, 0), cube.axis(2).values.size())
          : cube.named(2, 0) + "; ";
  canvas.text(28, 66, third + fmt::format("dB re 1 m2, maximum {:.1f}", cube.strongest()), label_size,
              palette.faint_ink);
  const std::vector<double>&across = cube.axis(0).values, &up = cube.axis(1).values;
  const auto level = [&](double db) {
    return std::clamp((db - cube.strongest() + shown_db) / shown_db, 0.0, 1.0);
  };
  for (int x = 0; x < width; ++x)
    for (int y = 0; y < height; ++y)
      canvas.blend(left + x, top + height - 1 - y,
                   DecibelScale::at_level(level(
                       cube.db(nearest(across, (x + 0.5) / width), nearest(up, (y + 0.5) / height), 0))));
  const double step_x = tick_step(across.back() - across.front(), 8),
               step_y = tick_step(up.back() - up.front(), 6);
  for (const double value : ticks(across.front(), across.back(), step_x)) {
    const int x =
        left +
        static_cast<int>(std::lround((value - across.front()) / (across.back() - across.front()) * width));
    canvas.fill(x, top + height, x + 1, top + height + 6, palette.faint_ink);
    canvas.label(x, top + height + 20, tick_label(value, step_x), label_size, palette.ink, Anchor::centre);
  }
  for (const double value : ticks(up.front(), up.back(), step_y)) {
    const int y = top + height -
                  static_cast<int>(std::lround((value - up.front()) / (up.back() - up.front()) * height));
    canvas.fill(left - 6, y, left, y + 1, palette.faint_ink);
    canvas.label(left - 12, y, tick_label(value, step_y), label_size, palette.ink, Anchor::right);
  }
  canvas.text(left + width / 2, top + height + 52, cube.axis(0).name, label_size, palette.ink,
              Anchor::centre);
  canvas.text(28, top - 18, cube.axis(1).name, label_size, palette.ink);
  for (int y = 0; y < height; ++y)
    canvas.fill(left + width + 30, top + y, left + width + 30 + bar, top + y + 1,
                DecibelScale::at_level(1 - (y + 0.5) / height));
  const double step_db = tick_step(shown_db, 6);
  for (const double db : ticks(cube.strongest() - shown_db, cube.strongest(), step_db))
    canvas.label(left + width + 30 + bar + 10, top + static_cast<int>(std::lround((1 - level(db)) * height)),
                 tick_label(db, step_db), label_size, palette.ink);
  canvas.write_png(file, "tubefoot: " + title_of(table));
}

}  // namespace

void write_picture(const StrengthTable& table, const std::filesystem::path& file) {
  const Cube cube(table);
  if (cube.axis(1).values.size() <= most_lines && cube.axis(2).values.size() == 1)
    table.comparison ? write_compared_lines(table, cube, file) : write_lines(table, cube, file);
  else
    write_map(table, cube, file);
}

}  // namespace tubefoot
