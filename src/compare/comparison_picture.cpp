// SPDX-License-Identifier: GPL-3.0-or-later
// Draws reference, candidate and their ratio in dB as three panels per sensor. A pixel shows the mean
// energy of the bins that it covers. Waterfalls have a time-varied gain of 40 log R.
#include "compare/comparison_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "compare/measures/echo_errors.hpp"
#include "sensors/pictures/decibel_scale.hpp"

namespace tubefoot {
namespace {

constexpr int margin = 28, title_height = 44, line_height = 24, panel_title_height = 34, axis_height = 58,
              axis_width = 72, gap = 26, legend_gap = 24, section_gap = 36;
constexpr int lowest = 260, highest = 720, narrowest = 300, widest = 420;

/// Bins that a pixel covers in a row or a column of the drawing: [first, last).
struct BinRange {
  std::size_t first = 0, last = 0;
};

/// Returns the bins that a pixel covers if `pixels` pixels share `bins` bins. These are several bins if
/// bins are finer than pixels, otherwise one bin.
BinRange bins_under(int pixel, int pixels, std::size_t bins) {
  const auto n = static_cast<double>(bins);
  const auto first = static_cast<std::size_t>(std::floor(pixel * n / pixels));
  const auto last = static_cast<std::size_t>(std::ceil((pixel + 1) * n / pixels - 1e-9));
  return {std::min(first, bins - 1), std::clamp(last, first + 1, bins)};
}

/// Table of energies that a panel shows, with columns to the right and rows upwards: one ping or all pings.
class Drawing {
 public:
  explicit Drawing(const ComparedEchoes& sensor)
      : sensor_(sensor), echoes_(*sensor.reference), waterfall_(drawn_as_waterfall(echoes_)) {
    columns_ = waterfall_ ? echoes_.beams * echoes_.samples : echoes_.beams;
    rows_ = waterfall_ ? echoes_.pings : echoes_.samples;
    // Each bin has a whole number of pixels if there are few bins.
    width_ = fitted(columns_, narrowest, widest);
    height_ = fitted(rows_, lowest, highest);
  }

  int width() const { return width_; }
  int height() const { return height_; }
  bool waterfall() const { return waterfall_; }

  /// Returns the mean energy of each pixel, row by row from the top.
  std::vector<double> pixels(const SensorEchoes& side) const {
    std::vector<double> result;
    result.reserve(static_cast<std::size_t>(width_) * height_);
    for (int y = 0; y < height_; ++y) {
      const BinRange rows = bins_under(height_ - 1 - y, height_, rows_);
      for (int x = 0; x < width_; ++x) {
        const BinRange columns = bins_under(x, width_, columns_);
        double sum = 0;
        for (std::size_t row = rows.first; row < rows.last; ++row)
          for (std::size_t column = columns.first; column < columns.last; ++column)
            sum += energy(side, row, column);
        result.push_back(sum /
                         static_cast<double>((rows.last - rows.first) * (columns.last - columns.first)));
      }
    }
    return result;
  }

  /// Returns the smallest energy of an insonified bin at a column or row, after the gain of its range.
  double lit_threshold(int x) const {
    return sensor_.lit_threshold_j *
           (waterfall_ ? gain(sample_of(bins_under(x, width_, columns_).first)) : 1);
  }

  /// Returns the pixel at the centre of a bin.
  static int middle(double bin, std::size_t bins, int pixels) {
    return static_cast<int>(std::floor((bin + 0.5) * pixels / static_cast<double>(bins)));
  }
  int x_of_column(double column) const { return middle(column, columns_, width_); }
  int y_of_row(double row) const { return height_ - 1 - middle(row, rows_, height_); }

  /// Returns the position of a slant range on the sample axis, counted from the centre of the first sample.
  double sample_at(double range_m) const {
    const auto& ranges = echoes_.slant_range_m;
    if (ranges.size() < 2) return 0;
    const auto above =
        std::clamp<std::ptrdiff_t>(std::lower_bound(ranges.begin(), ranges.end(), range_m) - ranges.begin(),
                                   1, static_cast<std::ptrdiff_t>(ranges.size()) - 1);
    const double low = ranges[above - 1], high = ranges[above];
    return static_cast<double>(above - 1) + (range_m - low) / (high - low);
  }
  /// Returns the column of a waterfall for a sample of a beam. The first of two beams extends to the left.
  double column_of(std::size_t beam, double sample) const {
    const auto samples = static_cast<double>(echoes_.samples);
    if (echoes_.beams == 1) return sample;
    return beam == 0 ? samples - 1 - sample : samples + sample;
  }
  const SensorEchoes& echoes() const { return echoes_; }

 private:
  static int fitted(std::size_t bins, int least, int most) {
    const auto n = static_cast<int>(std::min<std::size_t>(bins, static_cast<std::size_t>(most)));
    if (n >= most) return most;
    return std::min(most, n * std::max(1, (least + n - 1) / n));
  }

  std::size_t sample_of(std::size_t column) const {
    const std::size_t samples = echoes_.samples;
    if (echoes_.beams == 1) return column;
    return column < samples ? samples - 1 - column : column - samples;
  }
  /// Compensates two-way spreading; without it the far half of a waterfall would be dark.
  double gain(std::size_t sample) const { return std::pow(std::max(echoes_.slant_range_m[sample], 0.0), 4); }

  double energy(const SensorEchoes& side, std::size_t row, std::size_t column) const {
    if (!waterfall_) return side.energy[(sensor_.ping * side.beams + column) * side.samples + row];
    const std::size_t beam = echoes_.beams == 2 && column >= echoes_.samples ? 1 : 0;
    const std::size_t sample = sample_of(column);
    return side.energy[(row * side.beams + beam) * side.samples + sample] * gain(sample);
  }

  const ComparedEchoes& sensor_;
  const SensorEchoes& echoes_;
  bool waterfall_;
  std::size_t columns_ = 0, rows_ = 0;
  int width_ = 0, height_ = 0;
};

/// Returns the range of the colour scale of the ratio, in dB. It is the smallest fixed range that
/// contains 98 % of the pixels with a difference.
double difference_range_db(std::vector<double> differences_db) {
  // Also removes pixels that are not shown.
  std::erase_if(differences_db, [](double d) { return !(std::abs(d) > 0); });
  if (differences_db.empty()) return 1;
  for (double& difference : differences_db) difference = std::abs(difference);
  const auto rank = static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(differences_db.size() - 1));
  std::nth_element(differences_db.begin(), differences_db.begin() + rank, differences_db.end());
  double range_db = 1e-9;
  for (int k = 0; range_db < differences_db[rank] && range_db < largest_error_db; ++k)
    range_db = (k % 2 == 0 ? 3 : 10) * std::pow(10, k / 2 - 9);
  return std::min(range_db, largest_error_db);
}

void frame(Canvas& canvas, int x, int y, int width, int height) {
  canvas.fill(x - 1, y - 1, x + width + 1, y, palette.grid, 0.55);
  canvas.fill(x - 1, y + height, x + width + 1, y + height + 1, palette.grid, 0.55);
  canvas.fill(x - 1, y, x, y + height, palette.grid, 0.55);
  canvas.fill(x + width, y, x + width + 1, y + height, palette.grid, 0.55);
}

void tick_below(Canvas& canvas, int x, int bottom, const std::string& label) {
  canvas.fill(x, bottom + 1, x + 1, bottom + 7, palette.faint_ink);
  canvas.label(x, bottom + 19, label, label_size, palette.ink, Anchor::centre);
}

void tick_left(Canvas& canvas, int left, int y, const std::string& label) {
  canvas.fill(left - 7, y, left - 1, y + 1, palette.faint_ink);
  canvas.label(left - 12, y, label, label_size, palette.ink, Anchor::right);
}

/// Returns a tick step that is a whole number.
double whole_step(std::size_t count, int wanted) {
  return std::max(1.0, tick_step(static_cast<double>(count), wanted));
}

void draw_axes(Canvas& canvas, const Drawing& drawing, int left, int top, bool labelled) {
  const SensorEchoes& echoes = drawing.echoes();
  const int bottom = top + drawing.height();
  const double near_m = echoes.slant_range_m.front(), far_m = echoes.slant_range_m.back();
  const double range_step = far_m > near_m ? tick_step(far_m - near_m, drawing.waterfall() ? 4 : 8) : 1;
  const auto ranges = ticks(near_m, far_m, range_step);
  const int middle = left + drawing.width() / 2;
  if (drawing.waterfall()) {
    if (labelled) canvas.text(left - 12, top - 22, "ping", label_size, palette.ink, Anchor::right);
    for (std::size_t beam = 0; beam < echoes.beams; ++beam)
      for (const double range : ranges)
        tick_below(canvas, left + drawing.x_of_column(drawing.column_of(beam, drawing.sample_at(range))),
                   bottom, tick_label(range, range_step));
    canvas.text(middle, bottom + 42, "slant range (m)", label_size, palette.ink, Anchor::centre);
    if (echoes.beams == 2) {
      canvas.text(left, bottom + 42, "beam 0", label_size, palette.ink);
      canvas.text(left + drawing.width(), bottom + 42, "beam 1", label_size, palette.ink, Anchor::right);
    }
    const double step = whole_step(echoes.pings, 8);
    for (const double ping : ticks(0, static_cast<double>(echoes.pings - 1), step))
      tick_left(canvas, left, top + drawing.y_of_row(ping), labelled ? tick_label(ping, 1) : "");
    return;
  }
  if (labelled) canvas.text(left - 12, top - 22, "range (m)", label_size, palette.ink, Anchor::right);
  const double step = whole_step(echoes.beams, 6);
  for (const double beam : ticks(0, static_cast<double>(echoes.beams - 1), step))
    tick_below(canvas, left + drawing.x_of_column(beam), bottom, tick_label(beam, 1));
  canvas.label(middle, bottom + 42,
               fmt::format("beam (azimuth {:.1f} to {:.1f} degrees)", echoes.beam_azimuth_deg.front(),
                           echoes.beam_azimuth_deg.back()),
               label_size, palette.ink, Anchor::centre);
  for (const double range : ranges)
    tick_left(canvas, left, top + drawing.y_of_row(drawing.sample_at(range)),
              labelled ? tick_label(range, range_step) : "");
}

/// Draws the colour bar of the ratio, as DecibelScale::draw_legend does for energies.
void draw_difference_legend(Canvas& canvas, double range_db, int x, int y0, int y1) {
  const int bar = 20, top = y0 + 2 * label_size, bottom = y1 - 2 * label_size;
  canvas.text(x, y0 + label_size / 2, "dB", label_size, palette.ink);
  canvas.fill(x - 1, top - 1, x + bar + 1, bottom + 1, palette.faint_ink);
  for (int y = top; y < bottom; ++y)
    canvas.fill(x, y, x + bar, y + 1, difference_colour(1 - 2 * (y - top + 0.5) / (bottom - top)));
  for (int k = -2; k <= 2; ++k) {
    const double decibel = k * range_db / 2;
    const int y = top + static_cast<int>(std::lround((0.5 - k / 4.0) * (bottom - top - 1)));
    canvas.fill(x + bar + 1, y, x + bar + 6, y + 1, palette.faint_ink);
    canvas.label(x + bar + 11, y, (k > 0 ? "+" : "") + fmt::format("{:g}", decibel), label_size, palette.ink);
  }
}

/// Three panels and two colour bars of a sensor.
class Section {
 public:
  Section(const ComparedEchoes& sensor)
      : drawing_(sensor),
        name_(sensor.reference->name),
        reference_(drawing_.pixels(*sensor.reference)),
        candidate_(drawing_.pixels(*sensor.candidate)),
        scale_(reference_) {
    std::vector<double> differences;
    for (std::size_t k = 0; k < reference_.size(); ++k)
      differences.push_back(shows_difference(k) ? decibel_error(reference_[k], candidate_[k]) : 0);
    range_db_ = difference_range_db(std::move(differences));
    const SensorEchoes& echoes = *sensor.reference;
    title_ =
        drawing_.waterfall()
            ? fmt::format("{}   {} pings, 40 log R gain", name_, echoes.pings)
            : fmt::format(
                  "{}   ping {}{}", name_, sensor.ping,
                  echoes.pings > 1 ? fmt::format(" (of {}), with the largest difference", echoes.pings) : "");
    title_ += scale_.reference_j() > 0 ? fmt::format("   (0 dB: {} dB re 1 J/m2{})",
                                                     tick_label(10 * std::log10(scale_.reference_j()), 0.1),
                                                     drawing_.waterfall() ? " at 1 m" : "")
                                       : "   (the reference has no echo)";
  }

  int width(const std::string& font) const {
    return std::max(text_width(title_, title_size, font), plots_width());
  }
  int plots_width() const {
    return axis_width + 3 * drawing_.width() + gap + 3 * legend_gap + 2 * DecibelScale::legend_width;
  }
  int height() const { return title_height + panel_title_height + drawing_.height() + axis_height; }

  void draw(Canvas& canvas, int x, int y) const {
    canvas.text(x, y + 12, title_, title_size, palette.ink);
    const int top = y + title_height + panel_title_height, bottom = top + drawing_.height();
    const int w = drawing_.width();
    const int bar_y0 = std::max(top, bottom - 400);
    const int first = x + axis_width, second = first + w + gap, bar = second + w + legend_gap,
              third = bar + DecibelScale::legend_width + legend_gap, last_bar = third + w + legend_gap;
    panel(canvas, first, top, "reference", true, [&](std::size_t k) { return scale_.colour(reference_[k]); });
    panel(canvas, second, top, "candidate", false,
          [&](std::size_t k) { return scale_.colour(candidate_[k]); });
    scale_.draw_legend(canvas, bar, bar_y0, bottom);
    panel(canvas, third, top, "candidate / reference", false, [&](std::size_t k) {
      if (!shows_difference(k)) return nothing_lit;
      return difference_colour(decibel_error(reference_[k], candidate_[k]) / range_db_);
    });
    draw_difference_legend(canvas, range_db_, last_bar, bar_y0, bottom);
  }

 private:
  static constexpr Colour nothing_lit{0.10f, 0.105f, 0.115f};

  bool shows_difference(std::size_t pixel) const {
    const double threshold = drawing_.lit_threshold(static_cast<int>(pixel % drawing_.width()));
    return reference_[pixel] > threshold || candidate_[pixel] > threshold;
  }

  template <typename ColourOf>
  void panel(Canvas& canvas, int left, int top, const char* name, bool labelled, ColourOf colour) const {
    canvas.text(left + drawing_.width() / 2, top - 17, name, label_size, palette.ink, Anchor::centre);
    for (int y = 0; y < drawing_.height(); ++y)
      for (int x = 0; x < drawing_.width(); ++x)
        canvas.blend(left + x, top + y, colour(static_cast<std::size_t>(y) * drawing_.width() + x));
    frame(canvas, left, top, drawing_.width(), drawing_.height());
    draw_axes(canvas, drawing_, left, top, labelled);
  }

  Drawing drawing_;
  std::string name_, title_;
  std::vector<double> reference_, candidate_;
  DecibelScale scale_;
  double range_db_ = 1;
};

}  // namespace

bool drawn_as_waterfall(const SensorEchoes& sensor) { return sensor.beams <= 2; }

Colour difference_colour(double level) {
  static constexpr std::array<Colour, 5> stops{{{0.05f, 0.22f, 0.55f},
                                                {0.35f, 0.62f, 0.90f},
                                                {0.93f, 0.93f, 0.91f},
                                                {0.95f, 0.50f, 0.35f},
                                                {0.60f, 0.05f, 0.10f}}};
  const double position = (std::clamp(level, -1.0, 1.0) + 1) / 2 * (stops.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(position), stops.size() - 2);
  return mix(stops[below], stops[below + 1], position - static_cast<double>(below));
}

Canvas draw_comparison(const std::vector<ComparedEchoes>& sensors, const std::vector<std::string>& subtitle,
                       const std::string& font) {
  if (sensors.empty()) throw std::invalid_argument("no sensor to draw");
  std::vector<Section> sections(sensors.begin(), sensors.end());
  int width = 0, height = 2 * margin + static_cast<int>(subtitle.size()) * line_height;
  for (const std::string& line : subtitle) width = std::max(width, text_width(line, label_size, font));
  for (const Section& section : sections) {
    width = std::max(width, section.width(font));
    height += section.height() + section_gap;
  }
  Canvas canvas(width + 2 * margin, height, palette.background, font);
  int y = margin;
  for (const Section& section : sections) {
    section.draw(canvas, margin, y);
    y += section.height() + section_gap;
  }
  for (const std::string& line : subtitle) {
    canvas.text(margin, y, line, label_size, palette.faint_ink);
    y += line_height;
  }
  return canvas;
}

}  // namespace tubefoot
