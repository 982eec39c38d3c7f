// SPDX-License-Identifier: GPL-3.0-or-later
// Draws the labels of echoes: objects, materials and mean heights of each sample. Pictures show one ping as
// a fan or in columns, or a whole track. Sample colours are label colours mixed by energy shares.

#include "sensors/pictures/label_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "sensors/model/lens_beams.hpp"
#include "sensors/pictures/camera_fan.hpp"
#include "sensors/pictures/decibel_scale.hpp"

namespace tubefoot {
namespace {

constexpr int label_header_height = 2 * page_margin + 50, panel_gap = 36, caption_height = 34, widest = 460,
              highest = 560, entry_height = 26, most_entries = 14, swatch = 16, points = 3;

/// Colour of an object or a material by its number; the first is often the seabed. The sequence repeats,
/// paler each time.
Colour label_colour(std::size_t label) {
  constexpr std::array<Colour, 9> hues{{{0.62f, 0.55f, 0.43f},
                                        {0.90f, 0.38f, 0.00f},
                                        {0.34f, 0.71f, 0.91f},
                                        {0.00f, 0.62f, 0.45f},
                                        {0.94f, 0.89f, 0.26f},
                                        {0.80f, 0.47f, 0.65f},
                                        {0.10f, 0.45f, 0.85f},
                                        {0.86f, 0.15f, 0.20f},
                                        {0.60f, 0.85f, 0.35f}}};
  constexpr Colour white{1, 1, 1};
  const auto round = static_cast<double>(label / hues.size());
  return mix(hues[label % hues.size()], white, 1 - 1 / (1 + 0.45 * round));
}
constexpr Colour unscattered_colour{1, 1, 1};

/// Colours from low to high: night, blue, green, sand. Lightness grows linearly.
Colour height_colour(double part) {
  constexpr std::array<Colour, 5> stops{{{0.13f, 0.16f, 0.38f},
                                         {0.16f, 0.40f, 0.62f},
                                         {0.24f, 0.64f, 0.66f},
                                         {0.62f, 0.80f, 0.52f},
                                         {0.98f, 0.90f, 0.66f}}};
  const double at = std::clamp(part, 0.0, 1.0) * (stops.size() - 1);
  const auto k = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  return mix(stops[k], stops[k + 1], at - static_cast<double>(k));
}

/// Maps a point of a panel, in pixels from its top left corner, to the cell under it; none outside of the
/// picture.
struct Layout {
  int width = widest, height = highest;
  struct Cell {
    std::size_t frame, cell;
  };
  std::function<std::optional<Cell>(double x, double y)> at;
};

bool is_fan(const Sensor& sensor) {
  const auto& beams = sensor.beams();
  return !sensor.is_across_track() && beams.size() > 2 &&
         std::ranges::adjacent_find(beams, [](const BeamAxis& a, const BeamAxis& b) {
           return !(a.azimuth_rad < b.azimuth_rad);
         }) == beams.end();
}

Layout fan_of(const Sensor& sensor) {
  std::vector<double> centres;
  for (const BeamAxis& beam : sensor.beams()) centres.push_back(beam.azimuth_rad);
  const std::vector<double> borders = borders_between(centres);
  const RangeSamples samples = sensor.samples();
  const double near = samples.first_m, far = near + samples.count * samples.step_m;
  double left = far, right = -far, low = far, high = -far;
  constexpr int steps = 720;
  for (int k = 0; k <= steps; ++k) {
    const double azimuth = borders.front() + (borders.back() - borders.front()) * k / steps;
    for (const double range : {near, far}) {
      left = std::min(left, range * std::sin(azimuth));
      right = std::max(right, range * std::sin(azimuth));
      low = std::min(low, range * std::cos(azimuth));
      high = std::max(high, range * std::cos(azimuth));
    }
  }
  const double per_m = std::min(widest / (right - left), highest / (high - low));
  return {int(std::ceil((right - left) * per_m)), int(std::ceil((high - low) * per_m)),
          [=](double x, double y) -> std::optional<Layout::Cell> {
            const double across = left + x / per_m, ahead = high - y / per_m;
            const auto border = std::ranges::upper_bound(
                borders, azimuth_between(borders.front(), borders.back(), across, ahead));
            const double sample = (std::hypot(across, ahead) - near) / samples.step_m;
            if (border == borders.begin() || border == borders.end() || sample < 0 || sample >= samples.count)
              return std::nullopt;
            return Layout::Cell{0, std::size_t(border - borders.begin() - 1) * std::size_t(samples.count) +
                                       std::size_t(sample)};
          }};
}

/// Beams are columns.
Layout columns_of(const Sensor& sensor) {
  const std::size_t beams = sensor.beams().size(), samples = std::size_t(sensor.samples().count);
  return {widest, highest, [=](double x, double y) -> std::optional<Layout::Cell> {
            const auto beam = std::min(std::size_t(x * double(beams) / widest), beams - 1),
                       sample = std::min(std::size_t(y * double(samples) / highest), samples - 1);
            return Layout::Cell{0, beam * samples + sample};
          }};
}

/// Frames are rows, the first at the bottom. The first of two beams is on the port side; a single beam
/// extends downwards.
Layout track_of(const Sensor& sensor, std::size_t frames) {
  const std::size_t samples = std::size_t(sensor.samples().count);
  if (sensor.beams().size() == 1)
    return {widest, highest, [=](double x, double y) -> std::optional<Layout::Cell> {
              return Layout::Cell{std::min(std::size_t(x * double(frames) / widest), frames - 1),
                                  std::min(std::size_t(y * double(samples) / highest), samples - 1)};
            }};
  return {widest, highest, [=](double x, double y) -> std::optional<Layout::Cell> {
            const auto row = std::min(std::size_t(y * double(frames) / highest), frames - 1);
            const double off = (x / widest * 2 - 1) * double(samples);
            const auto sample = std::min(std::size_t(std::abs(off)), samples - 1);
            return Layout::Cell{frames - 1 - row, (off < 0 ? 0 : samples) + sample};
          }};
}

/// Colours by sample; none for samples without energy.
using Colours = std::vector<std::optional<Colour>>;

Colours mixed(std::span<const double> shares, std::span<const double> unscattered, std::size_t cells) {
  Colours colours(cells);
  const std::size_t labels = shares.size() / cells;
  for (std::size_t cell = 0; cell < cells; ++cell) {
    Colour sum{};
    double all = 0;
    const auto add = [&](double share, Colour colour) {
      all += share;
      sum.red += float(share) * colour.red;
      sum.green += float(share) * colour.green;
      sum.blue += float(share) * colour.blue;
    };
    for (std::size_t k = 0; k < labels; ++k) add(shares[k * cells + cell], label_colour(k));
    if (!unscattered.empty()) add(unscattered[cell], unscattered_colour);
    if (all > 0) colours[cell] = sum;
  }
  return colours;
}

struct Extremes {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void take(std::span<const double> values) {
    for (const double value : values)
      if (!std::isnan(value)) {
        low = std::min(low, value);
        high = std::max(high, value);
      }
  }
  /// Differences below a millimetre count as level, so that rounding errors are no relief.
  double part(double value) const { return high - low > 1e-3 ? (value - low) / (high - low) : 0.5; }
};

/// Adds up the shares of each label.
void note_seen(std::span<const double> shares, std::size_t cells, std::map<std::size_t, double>& seen) {
  for (std::size_t k = 0; k * cells < shares.size(); ++k)
    for (const double share : shares.subspan(k * cells, cells))
      if (share > 0) seen[k] += share;
}

/// The drawn data of some pings.
struct Frames {
  std::vector<Colours> objects, materials;  ///< by ping
  std::vector<std::vector<double>> heights;
  Extremes extremes;
  std::map<std::size_t, double> objects_seen, materials_seen;
  bool unscattered = false;
};

Frames frames_of(const LabelRecording& label_recording, std::span<const std::size_t> pings) {
  Frames frames;
  for (const std::size_t ping : pings) {
    LabelPing own = label_recording.of(ping);
    frames.objects.push_back(mixed(own.object_share, own.unscattered_share, label_recording.cells));
    frames.materials.push_back(mixed(own.material_share, own.unscattered_share, label_recording.cells));
    frames.extremes.take(own.mean_height);
    note_seen(own.object_share, label_recording.cells, frames.objects_seen);
    note_seen(own.material_share, label_recording.cells, frames.materials_seen);
    frames.unscattered = frames.unscattered ||
                         std::ranges::any_of(own.unscattered_share, [](double share) { return share > 0; });
    frames.heights.push_back(std::move(own.mean_height));
  }
  return frames;
}

void draw_panel(Canvas& canvas, int left, const Layout& layout, const std::vector<Colours>& frames,
                const std::string& caption) {
  canvas.text(left, label_header_height - caption_height / 2, caption, label_size, palette.ink);
  for (int y = 0; y < layout.height; ++y)
    for (int x = 0; x < layout.width; ++x) {
      Colour sum{};
      int inside = 0;
      for (int j = 0; j < points; ++j)
        for (int i = 0; i < points; ++i) {
          const auto at = layout.at(x + (i + 0.5) / points, y + (j + 0.5) / points);
          if (!at) continue;
          const std::optional<Colour>& colour = frames[at->frame][at->cell];
          if (!colour) continue;
          sum.red += colour->red;
          sum.green += colour->green;
          sum.blue += colour->blue;
          ++inside;
        }
      if (inside == 0) continue;
      const float per = 1 / float(inside);
      canvas.blend(left + x, label_header_height + y, {sum.red * per, sum.green * per, sum.blue * per},
                   inside / double(points * points));
    }
}

void draw_entry(Canvas& canvas, int x, int y, Colour colour, const std::string& name) {
  canvas.fill(x, y - swatch / 2, x + swatch, y + swatch / 2, colour);
  canvas.text(x + swatch + 10, y, name, label_size, palette.ink);
}

/// Draws the names of the visible labels, in descending order of their shares.
void draw_names(Canvas& canvas, int x, int y, const std::vector<std::string>& names,
                const std::map<std::size_t, double>& seen, bool unscattered) {
  std::vector<std::pair<double, std::size_t>> order;
  for (const auto& [label, sum] : seen) order.emplace_back(-sum, label);
  std::ranges::sort(order);
  int drawn = 0;
  for (const auto& [sum, label] : order) {
    if (drawn == most_entries) {
      canvas.text(x, y, fmt::format("and {} more", order.size() - most_entries), label_size,
                  palette.faint_ink);
      return;
    }
    draw_entry(canvas, x, y, label_colour(label), names[label]);
    y += entry_height;
    ++drawn;
  }
  if (unscattered) draw_entry(canvas, x, y, unscattered_colour, "without scattering");
}

void draw_heights(Canvas& canvas, int x, int y, int width, const Extremes& heights) {
  if (!(heights.high >= heights.low)) {
    canvas.text(x, y, "nothing is heard", label_size, palette.faint_ink);
    return;
  }
  for (int k = 0; k < width; ++k)
    canvas.fill(x + k, y - swatch / 2, x + k + 1, y + swatch / 2, height_colour(k / double(width - 1)));
  const double step = tick_step(std::max(heights.high - heights.low, 0.1), 4);
  canvas.text(x, y + entry_height, tick_label(heights.low, step / 10) + " m", label_size, palette.ink);
  canvas.text(x + width, y + entry_height, tick_label(heights.high, step / 10) + " m", label_size,
              palette.ink, Anchor::right);
}

Canvas draw(const LabelRecording& label_recording, const Layout& layout, const Frames& frames,
            const std::string& title, const std::string& subtitle, const std::string& font) {
  std::vector<Colours> heights;
  for (const std::vector<double>& ping : frames.heights) {
    Colours& own = heights.emplace_back(label_recording.cells);
    for (std::size_t cell = 0; cell < label_recording.cells; ++cell)
      if (!std::isnan(ping[cell])) own[cell] = height_colour(frames.extremes.part(ping[cell]));
  }
  const auto entries = static_cast<int>(
      std::min<std::size_t>(
          std::max({frames.objects_seen.size(), frames.materials_seen.size(), std::size_t{2}}),
          most_entries) +
      1);
  const int pitch = std::max(layout.width, 260) + panel_gap;
  const int width = std::max(
      {3 * pitch - panel_gap, text_width(title, title_size, font), text_width(subtitle, label_size, font)});
  Canvas canvas(2 * page_margin + width,
                label_header_height + layout.height + page_margin + entries * entry_height + page_margin,
                palette.background, font);
  canvas.text(page_margin, page_margin, title, title_size, palette.ink);
  canvas.text(page_margin, page_margin + 30, subtitle, label_size, palette.faint_ink);
  const int below = label_header_height + layout.height + page_margin;
  draw_panel(canvas, page_margin, layout, frames.objects, "objects");
  draw_names(canvas, page_margin, below, label_recording.objects, frames.objects_seen, frames.unscattered);
  draw_panel(canvas, page_margin + pitch, layout, frames.materials, "materials");
  draw_names(canvas, page_margin + pitch, below, label_recording.materials, frames.materials_seen,
             frames.unscattered);
  draw_panel(canvas, page_margin + 2 * pitch, layout, heights, "mean height");
  draw_heights(canvas, page_margin + 2 * pitch, below, std::max(layout.width, 260), frames.extremes);
  return canvas;
}

std::string name_of(const Recording& recording) { return recording.sensor->description().name; }

}  // namespace

Canvas draw_labels_of_ping(const Recording& recording, const LabelRecording& label_recording,
                           std::size_t ping, const std::string& font) {
  const Sensor& sensor = *recording.sensor;
  const bool fan = is_fan(sensor);
  return draw(
      label_recording, fan ? fan_of(sensor) : columns_of(sensor),
      frames_of(label_recording, std::array{ping}),
      fmt::format("{}   ping {}   objects and materials of the echoes", name_of(recording), ping),
      fmt::format(
          "colours are mixed by the shares of energy; {} to {} m{}",
          tick_label(sensor.samples().first_m, 0.01),
          tick_label(sensor.samples().first_m + sensor.samples().count * sensor.samples().step_m, 0.01),
          fan ? "" : ", one column per beam, nearest range bin on top"),
      font);
}

Canvas draw_labels_of_track(const Recording& recording, const LabelRecording& label_recording,
                            const std::string& font) {
  const Sensor& sensor = *recording.sensor;
  const std::size_t all = recording.pings(),
                    rows = std::min<std::size_t>(all, sensor.beams().size() == 1 ? widest : highest);
  std::vector<std::size_t> pings;
  for (std::size_t row = 0; row < rows; ++row) pings.push_back(row * all / rows);
  return draw(label_recording, track_of(sensor, rows), frames_of(label_recording, pings),
              fmt::format("{}   {} pings   objects and materials of the echoes", name_of(recording), all),
              fmt::format("colours are mixed by the shares of energy; {}",
                          sensor.beams().size() == 1 ? "first ping left, nearest range bin on top"
                                                     : "first ping at the bottom, port left"),
              font);
}

}  // namespace tubefoot
