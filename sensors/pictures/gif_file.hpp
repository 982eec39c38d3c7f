// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace tubefoot {

/// A picture with one byte per pixel, which is the number of its colour. Number 0 has no colour.
struct IndexedPicture {
  std::vector<std::array<std::uint8_t, 3>> colours;  ///< red, green, blue of the numbers from 1; at most 255
  std::vector<std::uint8_t> pixels;
};

/// Reduces a picture to at most 255 colours. `rgb`: 65536 red + 256 green + blue by pixel. Up to 255 colours
/// remain as they are. Others are divided along the axis of their largest variance into 255 groups (Wan,
/// Prusinkiewicz and Wong 1990). Each group gets its mean colour.
IndexedPicture indexed(std::span<const std::uint32_t> rgb);

/// The reason why an animation cannot be encoded.
struct GifError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// An animation under construction, in memory. giflib compresses it.
class GifFile {
 public:
  /// Frames follow each other after `delay` hundredths of a second, and the animation repeats without end.
  /// Throws GifError, as all functions do.
  GifFile(int width, int height, int delay);
  ~GifFile();
  GifFile(const GifFile&) = delete;
  GifFile& operator=(const GifFile&) = delete;

  /// Adds a frame, `picture` = indexed(rgb). The file contains only the rectangle of pixels that differ from
  /// the frame before, and no colour for equal pixels in it.
  void add(std::vector<std::uint32_t> rgb, const IndexedPicture& picture);
  /// Ends the animation and returns the bytes of the file.
  std::vector<unsigned char> finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tubefoot
