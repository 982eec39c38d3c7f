// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sensors/pictures/camera_picture.hpp"
#include "sensors/recordings/receiver_output.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// Selects the pings of a recording that its animation shows: all, or 200 uniformly spaced ones, including
/// the first and the last.
std::vector<std::size_t> animation_frames(std::size_t pings);

/// Animations of the pings of an acoustic camera, one of the recording and others as received. The tables of
/// the fan are computed once.
class CameraAnimation {
 public:
  /// `font` as for Canvas. The recording must outlive this object.
  CameraAnimation(const Recording& recording, const std::string& font);

  /// Writes a GIF that shows pings in a loop. Its fans have half the size of those of draw_camera_frame(),
  /// and one decibel scale. The frame rate is that of the pings, limited to 1 to 20 per second.
  /// `receiver_output` has the same meaning as there. Throws std::runtime_error with the file's name.
  void write(const std::filesystem::path& file, const ReceiverOutput* receiver_output = nullptr) const;

 private:
  const Recording& recording_;
  CameraFrames drawing_;
};

}  // namespace tubefoot
