// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/pictures/phase_picture.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "sensors/detection/receiver_pair_soundings.hpp"
#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/pictures/phase_colour.hpp"
#include "sensors/pictures/pixel_span.hpp"

namespace tubefoot {
namespace {

constexpr int phase_header_height = 2 * page_margin + 44, phase_axis_width = 72;

/// Adds the samples of one ping under a pixel.
void add(const ReceiverPairPing& ping, std::size_t beam, PixelSpan samples, const InterferometricNoise* noise,
         InterferometricSample& sum) {
  for (std::size_t k = samples.first; k < samples.end; ++k) {
    const InterferometricSample own = noise ? ping.received(beam, k, *noise) : ping.ideal(beam, k);
    sum.upper_j += own.upper_j;
    sum.lower_j += own.lower_j;
    sum.cross_j += own.cross_j;
  }
}

Colour colour_of(const InterferometricSample& sum) {
  const std::optional<double> phase = sum.phase_rad();
  return phase ? phase_colour(*phase, sum.coherence()) : phase_colour(0, 0);
}

}  // namespace

Canvas draw_phases(const Recording& recording, const std::string& font, const InterferometricNoise* noise) {
  const Sensor& sensor = *recording.sensor;
  const RangeSamples& samples = sensor.samples();
  const auto count = static_cast<std::size_t>(samples.count);
  const int side = static_cast<int>(std::clamp<std::size_t>(count, 300, 600));
  const int rows = static_cast<int>(std::clamp<std::size_t>(recording.pings(), 480, 1500));
  const int left = page_margin + phase_axis_width, top = phase_header_height, bottom = top + rows,
            middle = left + side;
  const std::string title =
      fmt::format("{}   phase of upper against lower receiver", sensor.description().name);
  const Sensor::ReceiverPair& receiver_pair = sensor.receiver_pair();
  const std::string subtitle = fmt::format(
      "{:g} kHz, baseline {:g} m, receiver pair tilted by {:g} degrees; brightness: coherence{}",
      sensor.frequency_khz(), receiver_pair.baseline_m, receiver_pair.tilt_deg, noise ? "; as received" : "");
  const int page_width = page_margin + std::max({middle + side + DecibelScale::legend_width + page_margin,
                                                 page_margin + text_width(title, title_size, font),
                                                 page_margin + text_width(subtitle, label_size, font)});
  Canvas canvas(page_width, bottom + axis_label_height + page_margin, palette.background, font);
  tbb::parallel_for(0, rows, [&](int row) {
    const PixelSpan pings = items_under(row, rows, recording.pings());
    std::vector<std::array<InterferometricSample, 2>> sums(static_cast<std::size_t>(side));
    for (std::size_t ping = pings.first; ping < pings.end; ++ping) {
      const ReceiverPairPing receiver_output(recording, ping);
      for (int x = 0; x < side; ++x)
        for (const std::size_t beam : {0, 1})
          add(receiver_output, beam, items_under(x, side, count), noise,
              sums[static_cast<std::size_t>(x)][beam]);
    }
    for (int x = 0; x < side; ++x) {
      const auto& [port, starboard] = sums[static_cast<std::size_t>(x)];
      canvas.blend(middle - 1 - x, bottom - 1 - row, colour_of(port));
      canvas.blend(middle + x, bottom - 1 - row, colour_of(starboard));
    }
  });

  canvas.text(page_margin, page_margin, title, title_size, palette.ink);
  canvas.text(page_margin, page_margin + 30, subtitle, label_size, palette.faint_ink);
  canvas.text(left, bottom + 42, "port", label_size, palette.ink);
  canvas.text(middle, bottom + 42, "slant range (m)", label_size, palette.ink, Anchor::centre);
  canvas.text(middle + side, bottom + 42, "starboard", label_size, palette.ink, Anchor::right);
  canvas.text(left - 12, top - 22, "ping", label_size, palette.ink, Anchor::right);
  draw_phase_legend(canvas, middle + side + page_margin, top, top + std::min(rows, 400));
  const double near_m = samples.first_m, far_m = samples.first_m + samples.count * samples.step_m;
  const double step_m = tick_step(far_m - near_m, 5);
  for (const double range : ticks(near_m, far_m, step_m)) {
    const int offset = static_cast<int>(std::lround((range - near_m) / (far_m - near_m) * side));
    for (const int x : {middle - offset, middle + offset}) {
      canvas.fill(x, bottom, x + 1, bottom + 6, palette.faint_ink);
      canvas.label(x, bottom + 18, tick_label(range, step_m), label_size, palette.ink, Anchor::centre);
      if (offset == 0) break;
    }
  }
  const auto pings = static_cast<double>(recording.pings());
  const double ping_step = std::max(1.0, tick_step(pings, std::max(2, rows / 60)));
  const double first = recording.number_of(0);
  for (const double ping : ticks(first, first + pings - 1, ping_step))
    canvas.label(left - 12, bottom - 1 - static_cast<int>((ping - first + 0.5) / pings * rows),
                 tick_label(ping, 1), label_size, palette.ink, Anchor::right);
  return canvas;
}

}  // namespace tubefoot
