// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "files/streamed_file.hpp"
#include "sensors/formats/camera_frame.hpp"

namespace tubefoot {

/// A DIDSON or ARIS file that is written frame by frame; memory for one frame. Without finish() nothing
/// remains. Throws std::invalid_argument for a header or frame that the format cannot keep (the file stays as
/// it was before that frame), std::runtime_error naming file and reason if it cannot be written.
class CameraFile {
 public:
  virtual ~CameraFile() = default;
  void add(const CameraFrame& frame);
  /// Puts what is known only now, the number of frames for one, into the header and closes the file. Throws
  /// std::logic_error without a frame: readers take such a file for a broken one.
  void finish();
  std::uint32_t frames() const { return frames_; }

 protected:
  struct Shape {
    int beams = 0, samples = 0;
    std::uint32_t most_frames = std::numeric_limits<std::uint32_t>::max();  ///< more are refused
  };
  CameraFile(const std::filesystem::path& file, const Shape& shape) : shape_(shape), file_(file) {}
  /// To be called once by what is derived, when file_header() has what it needs.
  void begin() { file_.append(file_header().bytes()); }

  virtual ByteRecord file_header() const = 0;
  virtual ByteRecord frame_header(const CameraFrame& frame) const = 0;
  /// Of the first frame; empty before it.
  const std::string& date() const { return date_; }
  std::uint64_t bytes() const { return file_.size(); }

 private:
  Shape shape_;
  std::uint32_t frames_ = 0;
  std::string date_;
  std::vector<std::uint8_t> amplitudes_;
  StreamedFile file_;
};

}  // namespace tubefoot
