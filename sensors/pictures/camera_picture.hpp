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

/// How large a frame's fan is at most, in pixels, and on what scale it is; none: its own.
struct CameraFrameLook {
  double widest = 1400, highest = 920;
  std::optional<DecibelScale> scale{};
};

/// Draws pings of an acoustic camera in fan geometry (CameraFan), all of one size. A pixel shows the mean
/// energy of the cells at a square of points in it. What is the same for all pings is found once.
class CameraFrames {
 public:
  /// `font` as for Canvas. The recording must outlive this.
  CameraFrames(const Recording& recording, std::string font, const CameraFrameLook& look = {});

  /// With `receiver_output`, what the instrument shows, on the scale of the ideal picture unless the receiver
  /// has a gain of its own. Threads may draw at once.
  Canvas draw(std::size_t ping, const ReceiverOutput* receiver_output = nullptr) const;

 private:
  const Recording& recording_;
  std::string font_;
  std::optional<DecibelScale> scale_;
  FanPage page_;
};

/// One of them.
Canvas draw_camera_frame(const Recording& recording, std::size_t ping, const std::string& font,
                         const ReceiverOutput* receiver_output = nullptr, const CameraFrameLook& look = {});

/// At most so many of the pings, evenly spread, the first and the last among them.
std::vector<std::size_t> spread_frames(std::size_t pings, std::size_t most);
/// Which pings of a recording its sequence shows: at most 20, evenly spread, the first and the last among
/// them.
std::vector<std::size_t> sequence_frames(std::size_t pings);
/// Draws them as small fans, five a row, all on one scale of decibels.
Canvas draw_camera_sequence(const Recording& recording, const std::string& font,
                            const ReceiverOutput* receiver_output = nullptr);

}  // namespace tubefoot
