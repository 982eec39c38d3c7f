// SPDX-License-Identifier: GPL-3.0-or-later
// Draws a sidescan recording as a waterfall: slant range to both sides, one row or several per ping. A gain
// of 40 log R + 2 alpha R applies. A pixel is the mean energy of its cells, weighted by their shares of it.

#include "sensors/pictures/waterfall_picture.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <span>
#include <utility>

#include "sensors/pictures/decibel_scale.hpp"

namespace tubefoot {
namespace {

constexpr int waterfall_header_height = 2 * page_margin + 52, waterfall_axis_width = 72;
constexpr int narrowest_side = 300, widest_side = 600, lowest = 240, highest = 3000;
constexpr std::size_t sides = 2;  // port, starboard

/// Cells [first, first + weights.size()) of a row of unit cells under an interval, and the part that each
/// fills.
struct CellSpan {
  std::size_t first = 0;
  std::vector<double> weights;
  double covered = 0;  ///< part of the interval that has cells, 0..1
};

CellSpan cells_under(double begin, double end, std::size_t count) {
  CellSpan span;
  const double from = std::max(begin, 0.0), to = std::min(end, static_cast<double>(count));
  if (!(to > from)) return span;
  span.first = static_cast<std::size_t>(from);
  for (std::size_t cell = span.first; static_cast<double>(cell) < to; ++cell) {
    const auto left = static_cast<double>(cell);
    span.weights.push_back(std::min(to, left + 1) - std::max(from, left));
  }
  span.covered = (to - from) / (end - begin);
  return span;
}

/// Mean distance between neighbouring pings, in metres; 0 for a sensor at rest.
double ping_spacing_m(const Recording& recording) {
  constexpr double at_rest_m = 1e-6;
  return recording.track_length_m() < at_rest_m ? 0 : recording.ping_spacing_m();
}

/// A time-varied gain that compensates spreading and absorption of both legs, 40 log R + 2 alpha R, as in
/// every sidescan display. Without it the far half of a waterfall is dark. It applies to pictures only.
std::vector<double> gain_by_sample(const Recording& recording) {
  const RangeSamples& samples = recording.sensor->samples();
  std::vector<double> gain(static_cast<std::size_t>(samples.count));
  for (std::size_t k = 0; k < gain.size(); ++k) {
    const double range_m = samples.first_m + (static_cast<double>(k) + 0.5) * samples.step_m;
    gain[k] = std::pow(range_m, 4) * std::pow(10, 2 * recording.absorption_db_per_km * range_m / 1e4);
  }
  return gain;
}

/// Rows [first, end) of the picture with the same contents: one ping repeated over all of them, or all pings
/// under a single row.
struct Strip {
  int first = 0, end = 0;
  CellSpan pings;
};

std::vector<Strip> strips_of(int rows, std::size_t pings) {
  const double rows_per_ping = rows / static_cast<double>(pings);
  std::vector<Strip> strips;
  for (int row = 0; row < rows; ++row) {
    CellSpan under = cells_under(row / rows_per_ping, (row + 1) / rows_per_ping, pings);
    const bool of_one = under.weights.size() == 1;
    if (of_one && !strips.empty() && strips.back().pings.weights.size() == 1 &&
        strips.back().pings.first == under.first)
      ++strips.back().end;
    else
      strips.push_back({row, row + 1, std::move(under)});
  }
  return strips;
}

/// Mean over the samples under a column that may contain a surface (there are `surfaces` of them), and the
/// fraction of the others.
struct ColumnEcho {
  double energy_j = 0;
  float beyond = 0;
};

ColumnEcho echo_under(std::span<const double> energy, const CellSpan& samples, int surfaces) {
  double sum = 0, weight = 0, beyond = 0;
  for (std::size_t s = 0; s < samples.weights.size(); ++s) {
    const std::size_t k = samples.first + s;
    if (!(energy[k] > 0) && k >= static_cast<std::size_t>(surfaces)) {
      beyond += samples.weights[s];
      continue;
    }
    sum += samples.weights[s] * energy[k];
    weight += samples.weights[s];
  }
  return {weight > 0 ? sum / weight : 0, weight + beyond > 0 ? float(beyond / (beyond + weight)) : 0};
}

}  // namespace

/// The values of a waterfall: [strip][beam][column, from the track outwards]. Its size is at most that of
/// the picture, for a line of any length.
struct Waterfall::Echoes {
  std::vector<double> energy_j;
  std::vector<float> beyond;
  bool ends_early = false;  ///< true if some beam has samples beyond all surfaces
};

/// Positions of pings, ranges and distances on the page.
struct Waterfall::Layout {
  explicit Layout(const Recording& recording) {
    const RangeSamples& samples = recording.sensor->samples();
    far_m = samples.first_m + samples.count * samples.step_m;
    side = std::clamp(static_cast<int>(std::ceil(far_m / samples.step_m)), narrowest_side, widest_side);
    pixels_per_m = side / far_m;
    spacing_m = ping_spacing_m(recording);
    const auto pings = static_cast<double>(recording.pings());
    const double wanted_rows = spacing_m > 0 ? pings * spacing_m * pixels_per_m : pings;
    rows = std::clamp(static_cast<int>(std::lround(std::min(wanted_rows, 1e6))), lowest, highest);
    stretch = rows / wanted_rows;
    strips = strips_of(rows, recording.pings());
    for (int x = 0; x < side; ++x)
      columns.push_back(cells_under((x / pixels_per_m - samples.first_m) / samples.step_m,
                                    ((x + 1) / pixels_per_m - samples.first_m) / samples.step_m,
                                    static_cast<std::size_t>(samples.count)));
  }

  double far_m, pixels_per_m, spacing_m, stretch;
  int side, rows;
  std::vector<Strip> strips;
  std::vector<CellSpan> columns;  ///< from the track outwards
};

Waterfall::Echoes Waterfall::echoes_of(const ReceiverOutput* receiver_output) const {
  std::vector<double> gain = gain_by_sample(recording_);
  if (receiver_output && receiver_output->has_gain) std::fill(gain.begin(), gain.end(), 1.0);
  const std::size_t count = gain.size(), side = layout_->columns.size();
  const std::vector<Strip>& strips = layout_->strips;
  Echoes all;
  all.energy_j.resize(strips.size() * sides * side);
  all.beyond.resize(all.energy_j.size());
  std::atomic<bool> ends_early = false;
  // Consecutive strips share pings. A thread processes several strips together and requests each ping once.
  constexpr std::size_t strips_at_least = 16;
  tbb::parallel_for(
      tbb::blocked_range(std::size_t{0}, strips.size(), strips_at_least), [&](const auto& some) {
        std::size_t requested = recording_.pings();  // the ping that is loaded
        std::optional<PingEnergies> ideal;
        std::vector<double> received, mean;
        std::vector<int> surfaces, farthest;
        for (std::size_t s = some.begin(); s < some.end(); ++s) {
          const CellSpan& under = strips[s].pings;
          const double weight = std::accumulate(under.weights.begin(), under.weights.end(), 0.0);
          mean.assign(sides * count, 0.0);
          farthest.assign(sides, recording_.surfaces ? 0 : static_cast<int>(count));
          for (std::size_t p = 0; p < under.weights.size(); ++p) {
            const std::size_t ping = under.first + p;
            if (requested != ping) {
              if (receiver_output)
                received = receiver_output->energy_of(ping);
              else
                ideal = recording_.energy_of(ping);
              if (recording_.surfaces) surfaces = recording_.surfaces(ping);
              requested = ping;
            }
            const std::span<const double> energy =
                receiver_output ? std::span<const double>(received) : ideal->values();
            const double share = under.weights[p] / weight;
            for (std::size_t beam = 0; beam < sides; ++beam) {
              for (std::size_t k = 0; k < count; ++k)
                mean[beam * count + k] += share * energy[beam * count + k] * gain[k];
              if (recording_.surfaces) farthest[beam] = std::max(farthest[beam], surfaces[beam]);
            }
          }
          for (std::size_t beam = 0; beam < sides; ++beam) {
            if (farthest[beam] < static_cast<int>(count)) ends_early = true;
            for (std::size_t x = 0; x < side; ++x) {
              const ColumnEcho echo = echo_under(std::span(mean).subspan(beam * count, count),
                                                 layout_->columns[x], farthest[beam]);
              const std::size_t place = (s * sides + beam) * side + x;
              all.energy_j[place] = echo.energy_j;
              all.beyond[place] = echo.beyond;
            }
          }
        }
      });
  all.ends_early = ends_early;
  return all;
}

Waterfall::Waterfall(const Recording& recording, std::string font)
    : recording_(recording),
      font_(std::move(font)),
      layout_(std::make_unique<Layout>(recording)),
      ideal_(std::make_unique<Echoes>(echoes_of(nullptr))),
      scale_(ideal_->energy_j, recording.sensor->description().signal.display_gain_db) {}

Waterfall::~Waterfall() = default;

Canvas Waterfall::draw(const ReceiverOutput* receiver_output) const {
  const Recording& recording = recording_;
  const Sensor& sensor = *recording.sensor;
  const RangeSamples& samples = sensor.samples();
  const auto& [far_m, pixels_per_m, spacing_m, stretch, side, rows, strips, columns] = *layout_;
  const auto pings = recording.pings();
  const double rows_per_ping = rows / static_cast<double>(pings);
  const bool own_gain = receiver_output && receiver_output->has_gain;
  const Echoes as_received = receiver_output ? echoes_of(receiver_output) : Echoes();
  const Echoes& drawn = receiver_output ? as_received : *ideal_;
  const DecibelScale scale =
      own_gain ? DecibelScale(drawn.energy_j, sensor.description().signal.display_gain_db) : scale_;

  const std::string title = fmt::format(
      "{}   pings {} to {}   t = {:.2f} to {:.2f} s", sensor.description().name, recording.number_of(0),
      recording.number_of(pings - 1), recording.ping_time_s.front(), recording.ping_time_s.back());
  std::string subtitle = fmt::format("{:g} kHz, {} samples over {:.2f} to {:.2f} m each side",
                                     sensor.frequency_khz(), samples.count, samples.first_m, far_m);
  if (spacing_m <= 0)
    subtitle += ", sensor at rest";
  else if (std::abs(stretch - 1) > 0.02)
    subtitle += ", along-track scale x " +
                (stretch < 10 ? fmt::format("{:.2g}", stretch) : fmt::format("{:.0f}", stretch));
  else
    subtitle += ", equal scales";
  if (receiver_output) subtitle += "; " + receiver_output->said;
  // Noise leaves no empty range bins. Columns nearer than the first range bin show nothing.
  bool has_empty = false;
  for (std::size_t place = 0; place < drawn.energy_j.size() && !has_empty; ++place)
    has_empty = !(drawn.energy_j[place] > 0) && columns[place % columns.size()].covered > 0;
  std::string footer = "no echo";
  if (scale.reference_j() > 0)
    footer =
        fmt::format("{}; 0 dB: {} dB re 1 J/m2 at 1 m{}{}",
                    own_gain ? "time-varied gain of the sonar" : "time-varied gain 40 log R + 2 alpha R",
                    tick_label(10 * std::log10(scale.reference_j()), 0.1), has_empty ? "; blue: no echo" : "",
                    has_empty && drawn.ends_early ? "; grey: no surface there" : "");

  const int left = page_margin + waterfall_axis_width, top = waterfall_header_height, bottom = top + rows,
            middle = left + side;
  const int right = middle + side;
  const int page_width = std::max({right + waterfall_axis_width + DecibelScale::legend_width,
                                   page_margin + text_width(title, title_size, font_),
                                   page_margin + widest_text({subtitle, footer}, label_size, font_)}) +
                         page_margin;
  Canvas canvas(page_width, bottom + axis_label_height + page_margin + 10, palette.background, font_);

  const auto draw_strip = [&, side = side, &strips = strips, &columns = columns](std::size_t s) {
    for (std::size_t beam = 0; beam < sides; ++beam)  // port, starboard
      for (int x = 0; x < side; ++x) {
        const auto column = static_cast<std::size_t>(x);
        if (columns[column].weights.empty()) continue;
        const std::size_t place = (s * sides + beam) * columns.size() + column;
        const Colour colour = scale.colour(drawn.energy_j[place], drawn.beyond[place]);
        for (int row = strips[s].first; row < strips[s].end; ++row)
          canvas.blend(beam == 0 ? middle - 1 - x : middle + x, bottom - 1 - row, colour,
                       columns[column].covered);
      }
  };
  tbb::parallel_for(std::size_t{0}, strips.size(), draw_strip);  // the first ping is the lowest

  canvas.fill(left - 1, top - 1, right + 1, top, palette.grid, 0.55);
  canvas.fill(left - 1, bottom, right + 1, bottom + 1, palette.grid, 0.55);
  canvas.fill(left - 1, top, left, bottom, palette.grid, 0.55);
  canvas.fill(right, top, right + 1, bottom, palette.grid, 0.55);
  canvas.text(page_margin, page_margin, title, title_size, palette.ink);
  canvas.text(page_margin, page_margin + 30, subtitle, label_size, palette.faint_ink);
  canvas.text(page_margin, canvas.height() - page_margin + 6, footer, label_size, palette.faint_ink);
  canvas.text(left, bottom + 44, "port", label_size, palette.ink);
  canvas.text(middle, bottom + 44, "slant range (m)", label_size, palette.ink, Anchor::centre);
  canvas.text(right, bottom + 44, "starboard", label_size, palette.ink, Anchor::right);
  canvas.text(left - 12, top - 22, "ping", label_size, palette.ink, Anchor::right);
  if (spacing_m > 0) canvas.text(right + 12, top - 22, "along track (m)", label_size, palette.ink);
  scale.draw_legend(canvas, right + waterfall_axis_width + 20, std::max(top, bottom - 400), bottom);

  const double range_step_m = tick_step(far_m, 5);
  for (const double range : ticks(0, far_m, range_step_m)) {
    const int offset = static_cast<int>(std::lround(range * pixels_per_m));
    for (const int x : {middle - offset, middle + offset}) {
      if (x > left && x < right) canvas.fill(x, top, x + 1, bottom, palette.grid, 0.16);
      canvas.fill(x, bottom + 1, x + 1, bottom + 7, palette.faint_ink);
      canvas.label(x, bottom + 20, tick_label(range, range_step_m), label_size, palette.ink, Anchor::centre);
      if (offset == 0) break;
    }
  }
  const int most_labels = std::max(2, rows / 60);
  const auto row_of_ping = [&](double ping) {
    return bottom - 1 - static_cast<int>(std::floor((ping + 0.5) * rows_per_ping));
  };
  const double ping_step = std::max(1.0, tick_step(static_cast<double>(pings), most_labels));
  const double first = recording.number_of(0);
  for (const double ping : ticks(first, first + static_cast<double>(pings - 1), ping_step)) {
    const int y = row_of_ping(ping - first);
    canvas.fill(left - 7, y, left - 1, y + 1, palette.faint_ink);
    canvas.label(left - 12, y, tick_label(ping, 1), label_size, palette.ink, Anchor::right);
  }
  if (spacing_m > 0) {
    const double length_m = static_cast<double>(pings - 1) * spacing_m;
    const double step_m = tick_step(length_m, most_labels);
    for (const double distance : ticks(0, length_m, step_m)) {
      const int y = row_of_ping(distance / spacing_m);
      canvas.fill(right + 1, y, right + 7, y + 1, palette.faint_ink);
      canvas.label(right + 12, y, tick_label(distance, step_m), label_size, palette.ink);
    }
  }
  return canvas;
}

}  // namespace tubefoot
