// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/formats/camera_file.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace tubefoot {

void CameraFile::add(const CameraFrame& frame) {
  const std::string what = fmt::format("{}: frame {}", file_.path().string(), frames_);
  if (frames_ == shape_.most_frames)
    throw std::invalid_argument(fmt::format("{}: the file holds at most {} frames", what, frames_));
  check(frame, what, shape_.beams, shape_.samples);
  reorder(frame.amplitudes, shape_.beams, shape_.samples, amplitudes_);
  file_.append(frame_header(frame).bytes());
  file_.append(amplitudes_);
  if (frames_ == 0) date_ = date_text(calendar_time(frame.unix_time_s));
  ++frames_;
}

void CameraFile::finish() {
  if (frames_ == 0)
    throw std::logic_error(fmt::format("{}: a file without frames cannot be read", file_.path().string()));
  file_.overwrite(0, file_header().bytes());
  file_.close();
}

}  // namespace tubefoot
