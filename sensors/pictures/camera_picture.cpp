// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/pictures/camera_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "sensors/model/angles.hpp"
#include "sensors/model/lens_beams.hpp"
#include "sensors/pictures/decibel_scale.hpp"

namespace tubefoot {
namespace {

constexpr int margin = 28, header_height = 2 * margin + 44, footer_height = 44;
constexpr int angle_label_gap = 20, range_label_gap = 12, range_label_width = 60;

/// The fan on the page: metres to the sides and ahead of the camera, and their pixels.
struct Fan {
  std::vector<double> borders_rad;  // of the beams
  double near_m, far_m, step_m;
  int beams, samples;
  double left_m = 0, right_m = 0, low_m = 0, high_m = 0;  // bounding box
  double pixels_per_m = 0;
  double apex_x = 0, apex_y = 0;

  Fan(const Sensor& sensor, double widest, double highest)
      : borders_rad(borders_of(sensor.beams())),
        near_m(sensor.samples().first_m),
        far_m(sensor.samples().first_m + sensor.samples().count * sensor.samples().step_m),
        step_m(sensor.samples().step_m),
        beams(static_cast<int>(sensor.beams().size())),
        samples(sensor.samples().count) {
    left_m = low_m = far_m;
    right_m = high_m = -far_m;
    constexpr int steps = 720;
    for (int k = 0; k <= steps; ++k) {
      const double azimuth = first_azimuth_rad() + extent_rad() * k / steps;
      for (const double range : {near_m, far_m}) {
        left_m = std::min(left_m, range * std::sin(azimuth));
        right_m = std::max(right_m, range * std::sin(azimuth));
        low_m = std::min(low_m, range * std::cos(azimuth));
        high_m = std::max(high_m, range * std::cos(azimuth));
      }
    }
    pixels_per_m = std::min(widest / (right_m - left_m), highest / (high_m - low_m));
  }

  static std::vector<double> borders_of(const std::vector<BeamAxis>& beams) {
    const BeamAxis& first = beams.front();
    if (beams.size() == 1)
      return {first.azimuth_rad - first.azimuth_width_rad / 2,
              first.azimuth_rad + first.azimuth_width_rad / 2};
    std::vector<double> centres;
    for (const BeamAxis& beam : beams) centres.push_back(beam.azimuth_rad);
    return borders_between(centres);
  }

  double first_azimuth_rad() const { return borders_rad.front(); }
  double last_azimuth_rad() const { return borders_rad.back(); }
  double extent_rad() const { return last_azimuth_rad() - first_azimuth_rad(); }
  double x(double azimuth, double pixels) const { return apex_x + pixels * std::sin(azimuth); }
  double y(double azimuth, double pixels) const { return apex_y - pixels * std::cos(azimuth); }
};

/// Mean energy of the cells under a pixel, and the part of the pixel that the fan covers.
struct PixelEcho {
  double energy_j = 0, coverage = 0;
};

PixelEcho echo_under(const Fan& fan, std::span<const double> energy, int x, int y, int points) {
  double sum = 0;
  int inside = 0;
  for (int j = 0; j < points; ++j) {
    for (int i = 0; i < points; ++i) {
      const double across = (x + (i + 0.5) / points - fan.apex_x) / fan.pixels_per_m;
      const double ahead = (fan.apex_y - y - (j + 0.5) / points) / fan.pixels_per_m;
      const auto border =
          std::upper_bound(fan.borders_rad.begin(), fan.borders_rad.end(), std::atan2(across, ahead));
      const double sample = (std::hypot(across, ahead) - fan.near_m) / fan.step_m;
      if (border == fan.borders_rad.begin() || border == fan.borders_rad.end() || sample < 0 ||
          sample >= fan.samples)
        continue;
      const auto beam = border - fan.borders_rad.begin() - 1;
      sum += energy[static_cast<std::size_t>(beam) * fan.samples + static_cast<std::size_t>(sample)];
      ++inside;
    }
  }
  if (inside == 0) return {};
  return {sum / inside, inside / static_cast<double>(points * points)};
}

/// Distance of the angle lines: what divides a circle well, at most eight parts, labels 50 pixels apart or
/// more.
double angle_step_deg(const Fan& fan) {
  const double extent_rad = fan.extent_rad();
  const double parts = std::clamp(std::floor(extent_rad * fan.far_m * fan.pixels_per_m / 50), 1.0, 8.0);
  for (const double step : {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0})
    if (degrees(extent_rad) <= parts * step) return step;
  return 45;
}

/// Distance of the range arcs: at most six parts, with room for their labels along the starboard edge.
double range_step_m(const Fan& fan) {
  const double steepness = std::abs(std::cos(fan.last_azimuth_rad()));
  const double gap = steepness > 0.4 ? 26 / steepness : 65;  // below each other, or side by side
  const double extent_m = fan.far_m - fan.near_m;
  return tick_step(extent_m,
                   static_cast<int>(std::clamp(std::floor(extent_m * fan.pixels_per_m / gap), 1.0, 6.0)));
}

/// How much of a line of one pixel's width covers a pixel at this distance.
double line_coverage(double distance_pixels) { return std::clamp(1 - std::abs(distance_pixels), 0.0, 1.0); }

/// Coverage by the range arcs and angle lines, at the middle of a pixel.
struct GridCoverage {
  double grid = 0, outline = 0;
};

GridCoverage grid_at(const Fan& fan, double x, double y, double range_step, double angle_step_rad) {
  const double across = x - fan.apex_x, ahead = fan.apex_y - y;
  const double range = std::hypot(across, ahead), azimuth = std::atan2(across, ahead);  // pixels, radians
  const double near = fan.near_m * fan.pixels_per_m, far = fan.far_m * fan.pixels_per_m;
  const double slack = 1 / std::max(range, 1.0);
  GridCoverage covered;
  const bool in_azimuth =
      azimuth >= fan.first_azimuth_rad() - slack && azimuth <= fan.last_azimuth_rad() + slack;
  if (!in_azimuth || range < near - 1 || range > far + 1) return covered;
  covered.outline = std::max(line_coverage(range - near), line_coverage(range - far));
  for (const double edge : {fan.first_azimuth_rad(), fan.last_azimuth_rad()})
    if (std::cos(azimuth - edge) > 0)
      covered.outline = std::max(covered.outline, line_coverage(range * std::sin(azimuth - edge)));
  const double arc = std::round(range / fan.pixels_per_m / range_step) * range_step;
  const double ray = std::round(azimuth / angle_step_rad) * angle_step_rad;
  covered.grid =
      std::max(line_coverage(range - arc * fan.pixels_per_m), line_coverage(range * std::sin(azimuth - ray)));
  return covered;
}

/// Supersampling of a pixel, a side.
int points_for(const Fan& fan) {
  return std::clamp(static_cast<int>(std::ceil(1 / (fan.pixels_per_m * fan.step_m))), 3, 8);
}

/// Metres along the starboard edge, degrees along the far arc.
void draw_labels(Canvas& canvas, const Fan& fan, double range_step, double angle_step) {
  for (const double range : ticks(fan.near_m, fan.far_m, range_step)) {
    const double azimuth = fan.last_azimuth_rad(), pixels = range * fan.pixels_per_m;
    const int x = static_cast<int>(std::lround(fan.x(azimuth, pixels) + range_label_gap));
    const int y = static_cast<int>(std::lround(fan.y(azimuth, pixels) + 5));  // beside the edge, not on it
    canvas.text(x, y, tick_label(range, range_step) + " m", label_size, palette.ink);
  }
  for (const double angle :
       ticks(degrees(fan.first_azimuth_rad()), degrees(fan.last_azimuth_rad()), angle_step)) {
    if (angle < -180 + angle_step / 2) continue;  // straight astern is labelled once, as +180
    const double azimuth = radians(angle), pixels = fan.far_m * fan.pixels_per_m + angle_label_gap;
    canvas.text(static_cast<int>(std::lround(fan.x(azimuth, pixels))),
                static_cast<int>(std::lround(fan.y(azimuth, pixels))),
                tick_label(angle, angle_step) + "\u00b0", label_size, palette.ink, Anchor::centre);
  }
}

}  // namespace

Canvas draw_camera_frame(const Recording& recording, std::size_t ping, const std::string& font,
                         const Heard* heard) {
  const Sensor& sensor = *recording.sensor;
  Fan fan(sensor, 1400, 920);
  const std::size_t cells = static_cast<std::size_t>(fan.beams) * fan.samples;
  const std::span<const double> ideal(recording.energy.data() + ping * cells, cells);
  const std::vector<double> received = heard ? heard->energy_of(ping) : std::vector<double>();
  const std::span<const double> energy = heard ? std::span<const double>(received) : ideal;
  const DecibelScale scale(heard && heard->has_gain ? energy : ideal,
                           sensor.description().signal.display_gain_db);

  const std::string title = fmt::format("{}   ping {}   t = {:.2f} s", sensor.description().name, ping,
                                        recording.ping_time_s[ping]);
  std::string subtitle =
      fmt::format("{:g} kHz, {} beam{} over {:g} degrees, {} samples over {:.2f} to {:.2f} m",
                  sensor.frequency_khz(), fan.beams, fan.beams == 1 ? "" : "s",
                  std::round(degrees(fan.extent_rad()) * 100) / 100, fan.samples, fan.near_m, fan.far_m);
  if (heard) subtitle += "; " + heard->said;
  const std::string footer = scale.reference_j() > 0
                                 ? fmt::format("0 dB: {} dB re 1 J; darkest: no echo",
                                               tick_label(10 * std::log10(scale.reference_j()), 0.1))
                                 : "no echo";

  // The fan, its labels and the legend side by side; short fans leave room for the title.
  const int fan_width = static_cast<int>(std::ceil((fan.right_m - fan.left_m) * fan.pixels_per_m));
  const int fan_height = static_cast<int>(std::ceil((fan.high_m - fan.low_m) * fan.pixels_per_m));
  const int drawing_height = std::max(fan_height, 200);  // room for the legend
  const int content = fan_width + 2 * range_label_width + DecibelScale::legend_width;
  const int width =
      2 * margin + std::max({content, text_width(title, title_size, font),
                             text_width(subtitle, label_size, font), text_width(footer, label_size, font)});
  const int fan_left = margin + range_label_width + (width - 2 * margin - content) / 2;
  fan.apex_x = fan_left - fan.left_m * fan.pixels_per_m;
  fan.apex_y = header_height + fan.high_m * fan.pixels_per_m;
  Canvas canvas(width, header_height + drawing_height + footer_height + margin, palette.background, font);

  const double range_step = range_step_m(fan), angle_step = angle_step_deg(fan);
  const int points = points_for(fan);
  for (int y = header_height - 2; y < header_height + fan_height + 2; ++y) {
    for (int x = fan_left - 2; x < fan_left + fan_width + 2; ++x) {
      const PixelEcho echo = echo_under(fan, energy, x, y, points);
      canvas.blend(x, y, scale.colour(echo.energy_j), echo.coverage);
      const GridCoverage lines = grid_at(fan, x + 0.5, y + 0.5, range_step, radians(angle_step));
      canvas.blend(x, y, palette.grid, 0.28 * lines.grid * echo.coverage);
      canvas.blend(x, y, palette.grid, 0.55 * lines.outline);
    }
  }

  draw_labels(canvas, fan, range_step, angle_step);
  canvas.text(margin, margin, title, title_size, palette.ink);
  canvas.text(margin, margin + 30, subtitle, label_size, palette.faint_ink);
  canvas.text(margin, canvas.height() - margin, footer, label_size, palette.faint_ink);
  const int legend_bottom = header_height + drawing_height;
  scale.draw_legend(canvas, width - margin - DecibelScale::legend_width + 20,
                    std::max(header_height, legend_bottom - 400), legend_bottom);
  return canvas;
}

std::vector<std::size_t> sequence_frames(std::size_t pings) {
  constexpr std::size_t most = 20;
  const std::size_t frames = std::min(pings, most);
  std::vector<std::size_t> picked;
  for (std::size_t k = 0; k < frames; ++k) picked.push_back(frames == 1 ? 0 : k * (pings - 1) / (frames - 1));
  return picked;
}

Canvas draw_camera_sequence(const Recording& recording, const std::string& font, const Heard* heard) {
  constexpr int columns_at_most = 5, gap = 16, caption_height = 30;
  const Sensor& sensor = *recording.sensor;
  Fan fan(sensor, 340, 260);
  const std::vector<std::size_t> frames = sequence_frames(recording.pings());
  std::vector<double> ideal, received;  // one scale for all of them
  for (const std::size_t ping : frames) {
    const std::span<const double> energy = recording.energy_of(ping);
    ideal.insert(ideal.end(), energy.begin(), energy.end());
    if (heard) {
      const std::vector<double> own = heard->energy_of(ping);
      received.insert(received.end(), own.begin(), own.end());
    }
    recording.let_go(ping);
  }
  const std::vector<double>& all = heard ? received : ideal;
  const DecibelScale scale(heard && heard->has_gain ? received : ideal,
                           recording.sensor->description().signal.display_gain_db);

  const int columns = std::min(columns_at_most, static_cast<int>(frames.size()));
  const int rows = (static_cast<int>(frames.size()) + columns - 1) / columns;
  const int fan_width = static_cast<int>(std::ceil((fan.right_m - fan.left_m) * fan.pixels_per_m));
  const int fan_height = static_cast<int>(std::ceil((fan.high_m - fan.low_m) * fan.pixels_per_m));
  const int cell_width = std::max(fan_width, 150) + gap, cell_height = fan_height + caption_height + gap;
  const std::string title =
      fmt::format("{}   {} of {} pings", sensor.description().name, frames.size(), recording.pings());
  const std::string subtitle =
      fmt::format("{:g} kHz, {:.2f} to {:.2f} m, one scale for all{}", sensor.frequency_khz(), fan.near_m,
                  fan.far_m, heard ? "; " + heard->said : std::string());
  const int content = std::max({columns * cell_width + DecibelScale::legend_width,
                                text_width(title, title_size, font), text_width(subtitle, label_size, font)});
  Canvas canvas(2 * margin + content, header_height + std::max(rows * cell_height, 240) + margin,
                palette.background, font);
  canvas.text(margin, margin, title, title_size, palette.ink);
  canvas.text(margin, margin + 30, subtitle, label_size, palette.faint_ink);
  const int points = points_for(fan);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const int left = margin + static_cast<int>(k) % columns * cell_width + (cell_width - gap - fan_width) / 2,
              top = header_height + static_cast<int>(k) / columns * cell_height;
    fan.apex_x = left - fan.left_m * fan.pixels_per_m;
    fan.apex_y = top + fan.high_m * fan.pixels_per_m;
    const std::span<const double> energy =
        std::span<const double>(all).subspan(k * recording.cells(), recording.cells());
    for (int y = top; y < top + fan_height; ++y)
      for (int x = left; x < left + fan_width; ++x) {
        const PixelEcho echo = echo_under(fan, energy, x, y, points);
        canvas.blend(x, y, scale.colour(echo.energy_j), echo.coverage);
      }
    canvas.text(left + fan_width / 2, top + fan_height + caption_height / 2,
                fmt::format("{}   {:.2f} s", frames[k], recording.ping_time_s[frames[k]]), label_size,
                palette.faint_ink, Anchor::centre);
  }
  const int legend_bottom = canvas.height() - margin;
  scale.draw_legend(canvas, canvas.width() - margin - DecibelScale::legend_width + 20,
                    std::max(header_height, legend_bottom - 400), legend_bottom);
  return canvas;
}

}  // namespace tubefoot
