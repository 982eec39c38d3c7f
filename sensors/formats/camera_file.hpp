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

/// A DIDSON or ARIS file that is written frame by frame, with one frame in memory. Without finish() the file
/// is removed. Throws std::invalid_argument for a header or frame that the format cannot represent; the file
/// then stays as it was before that frame. Throws std::runtime_error that names file and reason if writing
/// fails.
class CameraFile {
 public:
  virtual ~CameraFile() = default;
  void add(const CameraFrame& frame);
  /// Completes the header, for example with the number of frames, and closes the file. Throws
  /// std::logic_error without a frame, because readers treat such a file as broken.
  void finish();
  std::uint32_t frames() const { return frames_; }

 protected:
  struct Shape {
    int beams = 0, samples = 0;
    std::uint32_t most_frames = std::numeric_limits<std::uint32_t>::max();  ///< further frames are rejected
  };
  CameraFile(const std::filesystem::path& file, const Shape& shape) : shape_(shape), file_(file) {}
  /// Derived classes call this function once, when file_header() has its data.
  void begin() { file_.append(file_header().bytes()); }

  virtual PacketBytes file_header() const = 0;
  virtual PacketBytes frame_header(const CameraFrame& frame) const = 0;
  /// Date of the first frame; empty before it.
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
