// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/pictures/camera_picture.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "sensors/model/angles.hpp"
#include "sensors/pictures/decibel_scale.hpp"

namespace tubefoot {
namespace {

constexpr int margin = 28, header_height = 2 * margin + 44, footer_height = 44;
constexpr int angle_label_gap = 20, range_label_gap = 12, range_label_width = 60;

std::vector<int> surfaces_of(const Recording& recording, std::size_t ping) {
  return recording.surfaces ? recording.surfaces(ping) : std::vector<int>();
}

bool ends_early(const CameraFan& fan, const PingEchoes& echoes) {
  return std::ranges::any_of(echoes.surfaces, [&](int samples) { return samples < fan.samples(); });
}

/// What the pixels of a ping look like. A cell that fills many of them is looked up on the scale once.
class FanColours {
 public:
  FanColours(const CameraPixels& pixels, const PingEchoes& echoes, const DecibelScale& scale)
      : pixels_(pixels), echoes_(echoes), scale_(scale), of_cells_(echoes.energy.size()) {}

  /// The colour, and which part of the pixel has it.
  struct Pixel {
    Colour colour;
    double coverage = 0;
  };
  Pixel at(int x, int y) {
    const std::int64_t cell = pixels_.only_cell_at(x, y);
    if (cell < 0) return found(x, y);
    std::optional<Colour>& colour = of_cells_[static_cast<std::size_t>(cell)];
    if (!colour) colour = found(x, y).colour;
    return {*colour, 1};
  }

 private:
  Pixel found(int x, int y) const {
    const PixelEcho echo = pixels_.echo_at(x, y, echoes_);
    if (!(echo.coverage > 0)) return {};
    return {scale_.colour(echo.energy_j, echo.beyond), echo.coverage};
  }

  const CameraPixels& pixels_;
  const PingEchoes& echoes_;
  const DecibelScale& scale_;
  std::vector<std::optional<Colour>> of_cells_;
};

/// Distance of the angle lines: what divides a circle well, at most eight parts, labels 50 pixels apart or
/// more.
double angle_step_deg(const CameraFan& fan) {
  const double extent_rad = fan.extent_rad();
  const double parts = std::clamp(std::floor(extent_rad * fan.far_m() * fan.pixels_per_m() / 50), 1.0, 8.0);
  for (const double step : {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0})
    if (degrees(extent_rad) <= parts * step) return step;
  return 45;
}

/// Distance of the range arcs: at most six parts, with room for their labels along the starboard edge.
double range_step_m(const CameraFan& fan) {
  const double steepness = std::abs(std::cos(fan.last_azimuth_rad()));
  const double gap = steepness > 0.4 ? 26 / steepness : 65;  // below each other, or side by side
  const double extent_m = fan.far_m() - fan.near_m();
  return tick_step(extent_m,
                   static_cast<int>(std::clamp(std::floor(extent_m * fan.pixels_per_m() / gap), 1.0, 6.0)));
}

/// Metres along the starboard edge, degrees along the far arc.
void draw_labels(Canvas& canvas, const CameraFan& fan, int left, int top, double range_step,
                 double angle_step) {
  const double edge = fan.last_azimuth_rad();
  const bool level = std::abs(std::cos(edge)) <= 0.4;  // beside the edge, not on it
  for (const double range : ticks(fan.near_m(), fan.far_m(), range_step)) {
    const double pixels = range * fan.pixels_per_m();
    const int x = left + static_cast<int>(std::lround(fan.x(edge, pixels))),
              y = top + static_cast<int>(std::lround(fan.y(edge, pixels)));
    canvas.label(level ? x : x + range_label_gap, level ? y + 22 : y + 5,
                 tick_label(range, range_step) + " m", label_size, palette.ink,
                 level ? Anchor::centre : Anchor::left);
  }
  for (const double angle :
       ticks(degrees(fan.first_azimuth_rad()), degrees(fan.last_azimuth_rad()), angle_step)) {
    if (angle < -180 + angle_step / 2) continue;  // straight astern is labelled once, as +180
    const double azimuth = radians(angle), pixels = fan.far_m() * fan.pixels_per_m() + angle_label_gap;
    canvas.label(left + static_cast<int>(std::lround(fan.x(azimuth, pixels))),
                 top + static_cast<int>(std::lround(fan.y(azimuth, pixels))),
                 tick_label(angle, angle_step) + "\u00b0", label_size, palette.ink, Anchor::centre);
  }
}

}  // namespace

CameraFrames::CameraFrames(const Recording& recording, std::string font, const CameraFrameLook& look)
    : recording_(recording),
      font_(std::move(font)),
      scale_(look.scale),
      fan_(*recording.sensor, look.widest, look.highest),
      pixels_(fan_) {
  constexpr int around = CameraPixels::around;
  const double range_step = range_step_m(fan_), angle_step = radians(angle_step_deg(fan_));
  for (int y = -around; y < fan_.height() + around; ++y)
    for (int x = -around; x < fan_.width() + around; ++x)
      lines_.push_back(fan_.lines_at(x + 0.5, y + 0.5, range_step, angle_step));
}

Canvas CameraFrames::draw(std::size_t ping, const Heard* heard) const {
  const Recording& recording = recording_;
  const Sensor& sensor = *recording.sensor;
  const CameraFan& fan = fan_;
  const std::string& font = font_;
  const std::span<const double> ideal = recording.energy_of(ping);
  const std::vector<double> received = heard ? heard->energy_of(ping) : std::vector<double>();
  const std::span<const double> energy = heard ? std::span<const double>(received) : ideal;
  const DecibelScale scale = scale_ ? *scale_
                                    : DecibelScale(heard && heard->has_gain ? energy : ideal,
                                                   sensor.description().signal.display_gain_db);
  const PingEchoes echoes{energy, surfaces_of(recording, ping)};

  const std::string title = fmt::format("{}   ping {}   t = {:.2f} s", sensor.description().name,
                                        recording.number_of(ping), recording.ping_time_s[ping]);
  std::string subtitle = fmt::format(
      "{:g} kHz, {} beam{} over {:g} degrees, {} samples over {:.2f} to {:.2f} m", sensor.frequency_khz(),
      fan.beams(), fan.beams() == 1 ? "" : "s", std::round(degrees(fan.extent_rad()) * 100) / 100,
      fan.samples(), fan.near_m(), fan.far_m());
  if (heard) subtitle += "; " + heard->said;
  const std::string footer = scale.reference_j() > 0
                                 ? fmt::format("0 dB: {} dB re 1 J; darkest: no echo{}",
                                               tick_label(10 * std::log10(scale.reference_j()), 0.1),
                                               ends_early(fan, echoes) ? "; grey: no surface there" : "")
                                 : "no echo";

  // The fan, its labels and the legend side by side; short fans leave room for the title.
  const int drawing_height = std::max(fan.height(), 200);  // room for the legend
  const int content = fan.width() + 2 * range_label_width + DecibelScale::legend_width;
  const int width =
      2 * margin + std::max({content, text_width(title, title_size, font),
                             text_width(subtitle, label_size, font), text_width(footer, label_size, font)});
  const int fan_left = margin + range_label_width + (width - 2 * margin - content) / 2;
  Canvas canvas(width, header_height + drawing_height + footer_height + margin, palette.background, font);

  constexpr int around = CameraPixels::around;
  FanColours colours(pixels_, echoes, scale);
  auto lines = lines_.begin();
  for (int y = -around; y < fan.height() + around; ++y)
    for (int x = -around; x < fan.width() + around; ++x, ++lines) {
      const FanColours::Pixel pixel = colours.at(x, y);
      const int column = fan_left + x, row = header_height + y;
      if (pixel.coverage > 0) {
        canvas.blend(column, row, pixel.colour, pixel.coverage);
        if (lines->grid > 0) canvas.blend(column, row, palette.grid, 0.28 * lines->grid * pixel.coverage);
      }
      if (lines->outline > 0) canvas.blend(column, row, palette.grid, 0.55 * lines->outline);
    }

  canvas.text(margin, margin, title, title_size, palette.ink);
  canvas.text(margin, margin + 30, subtitle, label_size, palette.faint_ink);
  canvas.text(margin, canvas.height() - margin, footer, label_size, palette.faint_ink);
  const int legend_bottom = header_height + drawing_height;
  scale.draw_legend(canvas, width - margin - DecibelScale::legend_width + 20,
                    std::max(header_height, legend_bottom - 400), legend_bottom);
  draw_labels(canvas, fan, fan_left, header_height, range_step_m(fan), angle_step_deg(fan));
  return canvas;
}

Canvas draw_camera_frame(const Recording& recording, std::size_t ping, const std::string& font,
                         const Heard* heard, const CameraFrameLook& look) {
  return CameraFrames(recording, font, look).draw(ping, heard);
}

std::vector<std::size_t> sequence_frames(std::size_t pings) { return spread_frames(pings, 20); }

std::vector<std::size_t> spread_frames(std::size_t pings, std::size_t most) {
  const std::size_t frames = std::min(pings, most);
  std::vector<std::size_t> picked;
  for (std::size_t k = 0; k < frames; ++k) picked.push_back(frames == 1 ? 0 : k * (pings - 1) / (frames - 1));
  return picked;
}

Canvas draw_camera_sequence(const Recording& recording, const std::string& font, const Heard* heard) {
  constexpr int columns_at_most = 5, gap = 16, caption_height = 30;
  const Sensor& sensor = *recording.sensor;
  const CameraFan fan(sensor, 340, 260);
  const CameraPixels pixels(fan);
  const std::vector<std::size_t> frames = sequence_frames(recording.pings());
  // One scale for all of them.
  std::vector<double> ideal(frames.size() * recording.cells()), received(heard ? ideal.size() : 0);
  tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t k) {
    const auto place = static_cast<std::ptrdiff_t>(k * recording.cells());
    std::ranges::copy(recording.energy_of(frames[k]), ideal.begin() + place);
    if (heard) std::ranges::copy(heard->energy_of(frames[k]), received.begin() + place);
    recording.let_go(frames[k]);
  });
  const std::vector<double>& all = heard ? received : ideal;
  const DecibelScale scale(heard && heard->has_gain ? received : ideal,
                           recording.sensor->description().signal.display_gain_db);

  const int columns = std::min(columns_at_most, static_cast<int>(frames.size()));
  const int rows = (static_cast<int>(frames.size()) + columns - 1) / columns;
  std::vector<std::string> captions;
  for (const std::size_t ping : frames)
    captions.push_back(fmt::format("{}   {:.2f} s", recording.number_of(ping), recording.ping_time_s[ping]));
  const int cell_width = std::max({fan.width(), 150, widest_text(captions, label_size, font) + 4}) + gap,
            cell_height = fan.height() + caption_height + gap;
  const std::string title =
      fmt::format("{}   {} of {} pings", sensor.description().name, frames.size(), recording.pings());
  const std::string subtitle =
      fmt::format("{:g} kHz, {:.2f} to {:.2f} m, one scale for all{}", sensor.frequency_khz(), fan.near_m(),
                  fan.far_m(), heard ? "; " + heard->said : std::string());
  const int content = std::max({columns * cell_width + DecibelScale::legend_width,
                                text_width(title, title_size, font), text_width(subtitle, label_size, font)});
  Canvas canvas(2 * margin + content, header_height + std::max(rows * cell_height, 240) + margin,
                palette.background, font);
  canvas.text(margin, margin, title, title_size, palette.ink);
  canvas.text(margin, margin + 30, subtitle, label_size, palette.faint_ink);
  const auto left_of = [&](std::size_t k) {
    return margin + static_cast<int>(k) % columns * cell_width + (cell_width - gap - fan.width()) / 2;
  };
  const auto top_of = [&](std::size_t k) {
    return header_height + static_cast<int>(k) / columns * cell_height;
  };
  tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t k) {
    const PingEchoes echoes{std::span<const double>(all).subspan(k * recording.cells(), recording.cells()),
                            surfaces_of(recording, frames[k])};
    FanColours colours(pixels, echoes, scale);
    for (int y = 0; y < fan.height(); ++y)
      for (int x = 0; x < fan.width(); ++x)
        if (const FanColours::Pixel pixel = colours.at(x, y); pixel.coverage > 0)
          canvas.blend(left_of(k) + x, top_of(k) + y, pixel.colour, pixel.coverage);
  });
  for (std::size_t k = 0; k < frames.size(); ++k)
    canvas.label(left_of(k) + fan.width() / 2, top_of(k) + fan.height() + caption_height / 2, captions[k],
                 label_size, palette.faint_ink, Anchor::centre);
  const int legend_bottom = canvas.height() - margin;
  scale.draw_legend(canvas, canvas.width() - margin - DecibelScale::legend_width + 20,
                    std::max(header_height, legend_bottom - 400), legend_bottom);
  return canvas;
}

}  // namespace tubefoot
