// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sensors/pictures/canvas.hpp"
#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/pictures/fan_page.hpp"
#include "sensors/recordings/receiver_output.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// Maximum size of a frame's fan in pixels.
struct CameraFrameLook {
  double widest = 1400, highest = 920;
};

/// Draws pings of an acoustic camera in fan geometry (CameraFan), all at one size. A pixel shows the mean
/// energy of the cells at a square of points in it. Data that all pings share are computed once.
class CameraFrames {
 public:
  /// `font` as for Canvas. The recording must outlive this object.
  CameraFrames(const Recording& recording, std::string font, const CameraFrameLook& look = {});

  /// Draws a ping. With `receiver_output` it shows the instrument's display, on the scale of the ideal
  /// picture unless the receiver has its own gain. `given` replaces that scale. Thread-safe.
  Canvas draw(std::size_t ping, const ReceiverOutput* receiver_output = nullptr,
              const std::optional<DecibelScale>& given = {}) const;

 private:
  const Recording& recording_;
  std::string font_;
  FanPage page_;
};

/// Draws a single frame.
Canvas draw_camera_frame(const Recording& recording, std::size_t ping, const std::string& font,
                         const ReceiverOutput* receiver_output = nullptr, const CameraFrameLook& look = {});

/// At most `most` of the pings, uniformly spaced, including the first and the last.
std::vector<std::size_t> spread_frames(std::size_t pings, std::size_t most);
/// Selects the pings of a recording that its sequence shows: at most 20, uniformly spaced, including the
/// first and the last.
std::vector<std::size_t> sequence_frames(std::size_t pings);
/// Draws the pings of the sequence as small fans, five per row, on one decibel scale. The tables of the fan
/// are computed once.
class CameraSequence {
 public:
  /// As for CameraFrames.
  CameraSequence(const Recording& recording, std::string font);
  Canvas draw(const ReceiverOutput* receiver_output = nullptr) const;

 private:
  const Recording& recording_;
  std::string font_;
  CameraFan fan_;
  CameraPixels pixels_;
};
/// Draws a single such picture.
Canvas draw_camera_sequence(const Recording& recording, const std::string& font,
                            const ReceiverOutput* receiver_output = nullptr);

}  // namespace tubefoot
