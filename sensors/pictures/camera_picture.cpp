// SPDX-License-Identifier: GPL-3.0-or-later
// Draws pings of an acoustic camera in fan geometry, one per page or as a sequence of small fans on one
// decibel scale. The energies are those of the recording or of the receiver's output.

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

constexpr int camera_header_height = 2 * page_margin + 44;

std::vector<int> surfaces_of(const Recording& recording, std::size_t ping) {
  return recording.surfaces ? recording.surfaces(ping) : std::vector<int>();
}

bool ends_early(const CameraFan& fan, const PingEchoes& echoes) {
  return std::ranges::any_of(echoes.surfaces, [&](int samples) { return samples < fan.samples(); });
}

}  // namespace

CameraFrames::CameraFrames(const Recording& recording, std::string font, const CameraFrameLook& look)
    : recording_(recording),
      font_(std::move(font)),
      page_(CameraFan(*recording.sensor, look.widest, look.highest)) {}

Canvas CameraFrames::draw(std::size_t ping, const ReceiverOutput* receiver_output,
                          const std::optional<DecibelScale>& given) const {
  const Recording& recording = recording_;
  const Sensor& sensor = *recording.sensor;
  const CameraFan& fan = page_.fan();
  const PingEnergies ideal = recording.energy_of(ping);
  const std::vector<double> received =
      receiver_output ? receiver_output->energy_of(ping) : std::vector<double>();
  const std::span<const double> energy = receiver_output ? std::span<const double>(received) : ideal.values();
  const DecibelScale scale =
      given ? *given
            : DecibelScale(receiver_output && receiver_output->has_gain ? energy : ideal.values(),
                           sensor.description().signal.display_gain_db);
  const PingEchoes echoes{energy, surfaces_of(recording, ping)};

  const std::string title = fmt::format("{}   ping {}   t = {:.2f} s", sensor.description().name,
                                        recording.number_of(ping), recording.ping_time_s[ping]);
  std::string subtitle = fmt::format(
      "{:g} kHz, {} beam{} over {:g} degrees, {} samples over {:.2f} to {:.2f} m", sensor.frequency_khz(),
      fan.beams(), fan.beams() == 1 ? "" : "s", std::round(degrees(fan.extent_rad()) * 100) / 100,
      fan.samples(), fan.near_m(), fan.far_m());
  if (receiver_output) subtitle += "; " + receiver_output->said;
  // Noise leaves no empty range bins.
  const bool has_empty = std::ranges::any_of(energy, [](double value) { return !(value > 0); });
  std::string footer = "no echo";
  if (scale.reference_j() > 0)
    footer = fmt::format("0 dB: {} dB re 1 J/m2{}{}", tick_label(10 * std::log10(scale.reference_j()), 0.1),
                         has_empty ? "; blue: no echo" : "",
                         has_empty && ends_early(fan, echoes) ? "; grey: no surface there" : "");

  return page_.draw({title, subtitle, footer}, echoes, scale, font_);
}

Canvas draw_camera_frame(const Recording& recording, std::size_t ping, const std::string& font,
                         const ReceiverOutput* receiver_output, const CameraFrameLook& look) {
  return CameraFrames(recording, font, look).draw(ping, receiver_output);
}

std::vector<std::size_t> sequence_frames(std::size_t pings) { return spread_frames(pings, 20); }

std::vector<std::size_t> spread_frames(std::size_t pings, std::size_t most) {
  const std::size_t frames = std::min(pings, most);
  std::vector<std::size_t> picked;
  for (std::size_t k = 0; k < frames; ++k) picked.push_back(frames == 1 ? 0 : k * (pings - 1) / (frames - 1));
  return picked;
}

CameraSequence::CameraSequence(const Recording& recording, std::string font)
    : recording_(recording), font_(std::move(font)), fan_(*recording.sensor, 340, 260), pixels_(fan_) {}

Canvas draw_camera_sequence(const Recording& recording, const std::string& font,
                            const ReceiverOutput* receiver_output) {
  return CameraSequence(recording, font).draw(receiver_output);
}

Canvas CameraSequence::draw(const ReceiverOutput* receiver_output) const {
  constexpr int columns_at_most = 5, gap = 16, caption_height = 30;
  const Recording& recording = recording_;
  const std::string& font = font_;
  const Sensor& sensor = *recording.sensor;
  const CameraFan& fan = fan_;
  const std::vector<std::size_t> frames = sequence_frames(recording.pings());
  // The sequence has one scale.
  std::vector<double> ideal(frames.size() * recording.cells()), received(receiver_output ? ideal.size() : 0);
  tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t k) {
    const auto place = static_cast<std::ptrdiff_t>(k * recording.cells());
    const PingEnergies kept = recording.energy_of(frames[k]);
    std::ranges::copy(kept.values(), ideal.begin() + place);
    if (receiver_output) std::ranges::copy(receiver_output->energy_of(frames[k]), received.begin() + place);
  });
  const std::vector<double>& all = receiver_output ? received : ideal;
  const DecibelScale scale(receiver_output && receiver_output->has_gain ? received : ideal,
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
                  fan.far_m(), receiver_output ? "; " + receiver_output->said : std::string());
  const int content = std::max({columns * cell_width + DecibelScale::legend_width,
                                text_width(title, title_size, font), text_width(subtitle, label_size, font)});
  Canvas canvas(2 * page_margin + content,
                camera_header_height + std::max(rows * cell_height, 240) + page_margin, palette.background,
                font);
  canvas.text(page_margin, page_margin, title, title_size, palette.ink);
  canvas.text(page_margin, page_margin + 30, subtitle, label_size, palette.faint_ink);
  const auto left_of = [&](std::size_t k) {
    return page_margin + static_cast<int>(k) % columns * cell_width + (cell_width - gap - fan.width()) / 2;
  };
  const auto top_of = [&](std::size_t k) {
    return camera_header_height + static_cast<int>(k) / columns * cell_height;
  };
  tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t k) {
    const PingEchoes echoes{std::span<const double>(all).subspan(k * recording.cells(), recording.cells()),
                            surfaces_of(recording, frames[k])};
    FanColours colours(pixels_, echoes, scale);
    for (int y = 0; y < fan.height(); ++y)
      for (int x = 0; x < fan.width(); ++x)
        if (const FanColours::Pixel pixel = colours.at(x, y); pixel.coverage > 0)
          canvas.blend(left_of(k) + x, top_of(k) + y, pixel.colour, pixel.coverage);
  });
  for (std::size_t k = 0; k < frames.size(); ++k)
    canvas.label(left_of(k) + fan.width() / 2, top_of(k) + fan.height() + caption_height / 2, captions[k],
                 label_size, palette.faint_ink, Anchor::centre);
  const int legend_bottom = canvas.height() - page_margin;
  scale.draw_legend(canvas, canvas.width() - page_margin - DecibelScale::legend_width + 20,
                    std::max(camera_header_height, legend_bottom - 400), legend_bottom);
  return canvas;
}

}  // namespace tubefoot
