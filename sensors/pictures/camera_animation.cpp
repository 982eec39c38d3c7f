// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the pings of an acoustic camera as an animated GIF of fans on one decibel scale. The frame rate is
// that of the pings, limited to 1 to 20 per second.

#include "sensors/pictures/camera_animation.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "files/checked_file.hpp"
#include "geometry/steps/in_order.hpp"
#include "sensors/pictures/camera_picture.hpp"
#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/pictures/gif_file.hpp"

namespace tubefoot {
namespace {

/// Time between frames in hundredths of a second, at the rate of the pings.
int delay_of(const Recording& recording, const std::vector<std::size_t>& frames) {
  constexpr double slowest = 1, fastest = 20;
  const double lasting_s = recording.ping_time_s[frames.back()] - recording.ping_time_s[frames.front()];
  const double rate = lasting_s > 0 ? static_cast<double>(frames.size() - 1) / lasting_s : fastest;
  return static_cast<int>(100.0f / static_cast<float>(std::clamp(rate, slowest, fastest)));
}

std::uint32_t eight_bits(float component) {
  const float inside = component > 0 ? std::min(component, 1.0f) : 0.0f;
  return static_cast<std::uint32_t>(inside * 255 + 0.5f);
}
std::uint32_t packed(float red, float green, float blue) {
  return eight_bits(red) << 16 | eight_bits(green) << 8 | eight_bits(blue);
}

/// The size of an animation, which is that of its first frame.
struct Extent {
  int width = 0, height = 0;

  /// Pixels of a frame. A frame of another size is cropped, or padded with the background.
  std::vector<std::uint32_t> pixels_of(const Canvas& frame) const {
    const Colour& back = palette.background;
    std::vector<std::uint32_t> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                                      packed(back.red, back.green, back.blue));
    for (int y = 0; y < std::min(height, frame.height()); ++y) {
      const float* component = frame.components().data() + std::ptrdiff_t{3} * y * frame.width();
      std::uint32_t* pixel = pixels.data() + std::ptrdiff_t{1} * y * width;
      for (int x = 0; x < std::min(width, frame.width()); ++x, component += 3)
        pixel[x] = packed(component[0], component[1], component[2]);
    }
    return pixels;
  }
};

/// A frame in the form of the file.
struct Frame {
  std::vector<std::uint32_t> rgb;
  IndexedPicture picture;
};

}  // namespace

std::vector<std::size_t> animation_frames(std::size_t pings) { return spread_frames(pings, 200); }

CameraAnimation::CameraAnimation(const Recording& recording, const std::string& font)
    : recording_(recording), drawing_(recording, font, {700, 460}) {}

void CameraAnimation::write(const std::filesystem::path& file, const ReceiverOutput* receiver_output) const {
  const Recording& recording = recording_;
  const std::vector<std::size_t> frames = animation_frames(recording.pings());
  std::vector<double> of_scale;  // one scale for all frames: that of the sequence's picture
  for (const std::size_t ping : sequence_frames(recording.pings())) {
    const PingEnergies ideal = recording.energy_of(ping);
    const std::vector<double> received = receiver_output != nullptr && receiver_output->has_gain
                                             ? receiver_output->energy_of(ping)
                                             : std::vector<double>();
    const std::span<const double> shown =
        received.empty() ? ideal.values() : std::span<const double>(received);
    of_scale.insert(of_scale.end(), shown.begin(), shown.end());
  }
  const DecibelScale scale(of_scale, recording.sensor->description().signal.display_gain_db);
  const auto draw = [&](std::size_t k) { return drawing_.draw(frames[k], receiver_output, scale); };
  try {
    const Canvas first = draw(0);
    const Extent extent{first.width(), first.height()};
    GifFile gif(extent.width, extent.height, delay_of(recording, frames));
    Steps steps("frames of an animation", frames.size());
    constexpr std::size_t bytes_a_pixel = 3 * sizeof(float) + sizeof(std::uint32_t) + 1;
    in_order(
        steps, 0, frames.size(), bytes_a_pixel * first.components().size() / 3,
        [&](std::size_t k) {
          Frame made{extent.pixels_of(k == 0 ? first : draw(k)), {}};
          made.picture = indexed(made.rgb);
          return made;
        },
        [&](std::size_t, Frame& made) { gif.add(std::move(made.rgb), made.picture); });
    write_file(file, gif.finish());
  } catch (const GifError& error) {
    throw write_error(file, std::string("cannot encode the animation: ") + error.what());
  }
}

}  // namespace tubefoot
