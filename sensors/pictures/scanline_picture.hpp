// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <memory>

namespace tubefoot {

/// A one-channel picture written row by row, from the top: memory holds a few rows however many there are. It
/// counts as written only when finish() has returned; until then it is taken away again on destruction.
class ScanlinePicture {
 public:
  /// Format and header as `spec` says (pixels of TypeDesc FLOAT or UINT16), the file's kind by its extension.
  /// Throws std::runtime_error naming the file and what failed, here and below.
  ScanlinePicture(const std::filesystem::path& file, int width, int height, OIIO::ImageSpec spec);
  ~ScanlinePicture();
  ScanlinePicture(const ScanlinePicture&) = delete;
  ScanlinePicture& operator=(const ScanlinePicture&) = delete;

  /// The next row: `width` values of the type that the spec names.
  void add_row(const void* values);
  /// Throws std::logic_error unless all rows are there.
  void finish();

 private:
  class Stream;
  void check(bool done);

  std::filesystem::path path_;
  std::unique_ptr<Stream> stream_;  // outlives what writes into it
  std::unique_ptr<OIIO::ImageOutput> output_;
  OIIO::ImageSpec spec_;
  int rows_ = 0;
};

}  // namespace tubefoot
