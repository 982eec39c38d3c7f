// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/pictures/echogram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/pictures/pixel_span.hpp"

namespace tubefoot {
namespace {

constexpr int echogram_header_height = 2 * page_margin + 44, echogram_axis_width = 72;
constexpr Colour bottom_colour{0.35f, 0.85f, 0.95f};

/// Mean of the cells under each pixel, row by row.
std::vector<double> pixels_of(std::span<const float> cells, std::size_t pings, std::size_t samples, int width,
                              int height) {
  std::vector<double> means;
  for (int y = 0; y < height; ++y) {
    const PixelSpan rows = items_under(y, height, samples);
    for (int x = 0; x < width; ++x) {
      const PixelSpan columns = items_under(x, width, pings);
      double sum = 0;
      for (std::size_t ping = columns.first; ping < columns.end; ++ping)
        for (std::size_t k = rows.first; k < rows.end; ++k) sum += cells[ping * samples + k];
      means.push_back(sum / static_cast<double>((columns.end - columns.first) * (rows.end - rows.first)));
    }
  }
  return means;
}

}  // namespace

Canvas draw_echogram(const Recording& recording, std::span<const float> energy_j,
                     std::span<const double> bottom_m, const std::string& font, const std::string& said) {
  const Sensor& sensor = *recording.sensor;
  const RangeSamples& samples = sensor.samples();
  const std::size_t pings = recording.pings(), count = static_cast<std::size_t>(samples.count);
  const double far_m = samples.first_m + samples.count * samples.step_m;
  const int width = static_cast<int>(std::clamp<std::size_t>(pings, 640, 1200));
  const int height = static_cast<int>(std::clamp<std::size_t>(count, 320, 720));
  const std::vector<double> means = pixels_of(energy_j, pings, count, width, height);
  const DecibelScale scale(means, sensor.description().signal.display_gain_db);

  const std::string title = fmt::format(
      "{}   pings {} to {}   t = {:.2f} to {:.2f} s", sensor.description().name, recording.number_of(0),
      recording.number_of(pings - 1), recording.ping_time_s.front(), recording.ping_time_s.back());
  const std::string subtitle = fmt::format(
      "{:g} kHz, {} samples over {:.2f} to {:.2f} m; line: detected bottom{}{}", sensor.frequency_khz(),
      samples.count, samples.first_m, far_m, said.empty() ? "" : "; ", said);
  const std::string footer = scale.reference_j() > 0
                                 ? fmt::format("0 dB: {} dB re 1 J/m2; blue: no echo",
                                               tick_label(10 * std::log10(scale.reference_j()), 0.1))
                                 : "no echo";
  const int left = page_margin + echogram_axis_width, top = echogram_header_height;
  const int page_width = std::max({left + width + DecibelScale::legend_width + page_margin,
                                   page_margin + text_width(title, title_size, font),
                                   page_margin + widest_text({subtitle, footer}, label_size, font)}) +
                         page_margin;
  Canvas canvas(page_width, top + height + axis_label_height + page_margin, palette.background, font);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      canvas.blend(left + x, top + y, scale.colour(means[static_cast<std::size_t>(y * width + x)]));
  const auto row_of = [&](double range_m) {
    return top +
           static_cast<int>(std::floor((range_m - samples.first_m) / (far_m - samples.first_m) * height));
  };
  for (int x = 0; x < width; ++x) {
    const double bottom = bottom_m[items_under(x, width, pings).first];
    if (std::isfinite(bottom)) canvas.blend(left + x, row_of(bottom), bottom_colour);
  }

  canvas.text(page_margin, page_margin, title, title_size, palette.ink);
  canvas.text(page_margin, page_margin + 30, subtitle, label_size, palette.faint_ink);
  canvas.text(page_margin, canvas.height() - page_margin + 6, footer, label_size, palette.faint_ink);
  canvas.text(left + width / 2, top + height + 42, "ping", label_size, palette.ink, Anchor::centre);
  canvas.text(left - 10, top - 22, "range (m)", label_size, palette.ink, Anchor::right);
  scale.draw_legend(canvas, left + width + page_margin, top, top + std::min(height, 400));
  const double range_step = tick_step(far_m - samples.first_m, 8);
  for (const double range : ticks(samples.first_m, far_m, range_step)) {
    canvas.fill(left, row_of(range), left + width, row_of(range) + 1, palette.grid, 0.16);
    canvas.label(left - 10, row_of(range), tick_label(range, range_step), label_size, palette.ink,
                 Anchor::right);
  }
  const double ping_step = std::max(1.0, tick_step(static_cast<double>(pings), 10));
  const double first = recording.number_of(0);
  for (const double ping : ticks(first, first + static_cast<double>(pings - 1), ping_step)) {
    const int x = left + static_cast<int>((ping - first + 0.5) / static_cast<double>(pings) * width);
    canvas.fill(x, top + height, x + 1, top + height + 6, palette.faint_ink);
    canvas.label(x, top + height + 18, tick_label(ping, 1), label_size, palette.ink, Anchor::centre);
  }
  return canvas;
}

}  // namespace tubefoot
