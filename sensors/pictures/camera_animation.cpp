// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the pings of an acoustic camera as an animated GIF of fans on one decibel scale. The frame rate is
// that of the pings, limited to 1 to 20 per second.

#include "sensors/pictures/camera_animation.hpp"

#include <OpenImageIO/filesystem.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "files/checked_file.hpp"
#include "geometry/steps/steps.hpp"
#include "sensors/pictures/camera_picture.hpp"
#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/pictures/image_file.hpp"

namespace tubefoot {
namespace {

/// Frames per second at the rate of the pings.
float frame_rate(const Recording& recording, const std::vector<std::size_t>& frames) {
  constexpr double slowest = 1, fastest = 20;
  const double lasting_s = recording.ping_time_s[frames.back()] - recording.ping_time_s[frames.front()];
  const double rate = lasting_s > 0 ? static_cast<double>(frames.size() - 1) / lasting_s : fastest;
  return static_cast<float>(std::clamp(rate, slowest, fastest));
}

/// A GIF under construction, in memory. The disk receives a complete file or none.
class Gif {
 public:
  Gif(std::filesystem::path file, int width, int height, std::size_t frames, float rate)
      : file_(std::move(file)),
        specs_(frames, OIIO::ImageSpec(width, height, 3, OIIO::TypeDesc::UINT8)),
        memory_(bytes_),
        output_(OIIO::ImageOutput::create(name())) {
    if (!output_) fail(OIIO::geterror());
    for (OIIO::ImageSpec& spec : specs_) {
      spec.attribute("FramesPerSecond", rate);
      spec.attribute("gif:LoopCount", 0);
    }
    output_->set_ioproxy(&memory_);
  }
  Gif(const Gif&) = delete;
  Gif& operator=(const Gif&) = delete;

  /// Adds a frame. A frame of another size is cropped, or padded with the background.
  void add(const Canvas& frame) {
    const int width = specs_.front().width, height = specs_.front().height;
    std::vector<float> pixels(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const float background[] = {palette.background.red, palette.background.green, palette.background.blue};
    for (std::size_t k = 0; k < pixels.size(); ++k) pixels[k] = background[k % 3];
    for (int y = 0; y < std::min(height, frame.height()); ++y)
      std::copy_n(frame.components().begin() + std::ptrdiff_t{3} * y * frame.width(),
                  3 * std::min(width, frame.width()), pixels.begin() + std::ptrdiff_t{3} * y * width);
    const bool opened = added_ == 0
                            ? output_->open(name(), static_cast<int>(specs_.size()), specs_.data())
                            : output_->open(name(), specs_[added_], OIIO::ImageOutput::AppendSubimage);
    ++added_;
    if (!opened || !output_->write_image(OIIO::TypeDesc::FLOAT, pixels.data())) fail(output_->geterror());
  }
  void finish() {
    if (!output_->close()) fail(output_->geterror());
    write_file(file_, bytes_);
  }

 private:
  std::string name() const { return file_.filename().string(); }
  [[noreturn]] void fail(const std::string& reason) const {
    throw write_error(file_, "cannot encode the animation: " + reason_in_words(reason));
  }

  std::filesystem::path file_;
  std::vector<OIIO::ImageSpec> specs_;
  std::vector<unsigned char> bytes_;
  OIIO::Filesystem::IOVecOutput memory_;
  std::unique_ptr<OIIO::ImageOutput> output_;
  std::size_t added_ = 0;
};

}  // namespace

std::vector<std::size_t> animation_frames(std::size_t pings) { return spread_frames(pings, 200); }

void write_camera_animation(const std::filesystem::path& file, const Recording& recording,
                            const std::string& font, const ReceiverOutput* receiver_output) {
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
  const CameraFrames drawing(
      recording, font,
      {700, 460, DecibelScale(of_scale, recording.sensor->description().signal.display_gain_db)});
  std::optional<Gif> gif;
  Steps steps("frames of an animation", frames.size());
  constexpr std::size_t block = 16;  // number of frames that all threads draw before one thread encodes them
  for (std::size_t first = 0; first < frames.size(); first += block) {
    std::vector<std::optional<Canvas>> drawn(std::min(block, frames.size() - first));
    tbb::parallel_for(std::size_t{0}, drawn.size(), [&](std::size_t k) {
      drawn[k].emplace(drawing.draw(frames[first + k], receiver_output));
    });
    if (!gif)
      gif.emplace(file, drawn.front()->width(), drawn.front()->height(), frames.size(),
                  frame_rate(recording, frames));
    for (const std::optional<Canvas>& frame : drawn) {
      gif->add(*frame);
      steps.done();
    }
  }
  gif->finish();
}

}  // namespace tubefoot
