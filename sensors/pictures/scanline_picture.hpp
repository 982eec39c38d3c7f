// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <memory>

namespace tubefoot {

/// A one-channel picture written row by row from the top, with only a few rows in memory. The file is
/// complete when finish() has returned; before that the destructor removes it.
class ScanlinePicture {
 public:
  /// `spec` gives format and header (pixels of TypeDesc FLOAT or UINT16), and the extension gives the type
  /// of the file. Throws std::runtime_error that names the file and the failed operation, as all functions
  /// below do.
  ScanlinePicture(const std::filesystem::path& file, int width, int height, OIIO::ImageSpec spec);
  ~ScanlinePicture();
  ScanlinePicture(const ScanlinePicture&) = delete;
  ScanlinePicture& operator=(const ScanlinePicture&) = delete;

  /// Adds the next row: `width` values of the type in the spec.
  void add_row(const void* values);
  /// Throws std::logic_error if rows are missing.
  void finish();

 private:
  class Stream;
  void check(bool done);

  std::filesystem::path path_;
  std::unique_ptr<Stream> stream_;  // must outlive output_, which writes into it
  std::unique_ptr<OIIO::ImageOutput> output_;
  OIIO::ImageSpec spec_;
  int rows_ = 0;
};

}  // namespace tubefoot
