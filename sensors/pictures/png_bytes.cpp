// SPDX-License-Identifier: GPL-3.0-or-later
// Encodes RGB pictures as PNG files (ISO/IEC 15948), with libdeflate. The combination of libpng and zlib
// takes five times as long, for a file that is no smaller (validation/performance.md).
#include "sensors/pictures/png_bytes.hpp"

#include <fmt/format.h>
#include <libdeflate.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <new>
#include <stdexcept>
#include <string_view>

#include "files/shown.hpp"

namespace tubefoot {
namespace {

using Bytes = std::vector<unsigned char>;

void append(Bytes& bytes, std::uint32_t number) {
  for (const int shift : {24, 16, 8, 0}) bytes.push_back(static_cast<unsigned char>(number >> shift));
}
void append(Bytes& bytes, std::string_view text) { bytes.insert(bytes.end(), text.begin(), text.end()); }

/// Completes a chunk whose type begins at `type`: appends its checksum and fills in its length.
void end_chunk(Bytes& png, std::size_t type) {
  const auto length = static_cast<std::uint32_t>(png.size() - type - 4);
  for (int k = 0; k < 4; ++k)
    png[type - 4 + static_cast<std::size_t>(k)] = static_cast<unsigned char>(length >> (24 - 8 * k));
  append(png, libdeflate_crc32(0, png.data() + type, png.size() - type));
}
/// Begins a chunk with a placeholder for its length. Returns the position of its type.
std::size_t begin_chunk(Bytes& png, std::string_view type) {
  append(png, std::uint32_t{0});
  append(png, type);
  return png.size() - type.size();
}

/// Negative components and NaN become 0; halves are rounded up.
std::uint32_t rounded(float component, float largest) {
  const float inside = component > 0 ? std::min(component, 1.0f) : 0.0f;
  return static_cast<std::uint32_t>(inside * largest + 0.5f);
}

/// Rows before compression, each after the number of its filter, 0 for none. Pictures of equal cells on a
/// uniform background compress no better with a filter, and faster without one.
Bytes rows_of(std::size_t width, std::size_t height, const float* component, int bits) {
  const std::size_t components = 3 * width;
  Bytes rows((components * static_cast<std::size_t>(bits / 8) + 1) * height);
  unsigned char* byte = rows.data();
  for (std::size_t row = 0; row < height; ++row) {
    ++byte;
    if (bits == 8) {
      for (std::size_t k = 0; k < components; ++k)
        *byte++ = static_cast<unsigned char>(rounded(*component++, 255));
    } else {
      for (std::size_t k = 0; k < components; ++k) {
        const std::uint32_t value = rounded(*component++, 65535);
        *byte++ = static_cast<unsigned char>(value >> 8);
        *byte++ = static_cast<unsigned char>(value);
      }
    }
  }
  return rows;
}

}  // namespace

Bytes png_bytes(int width, int height, std::span<const float> components, int bits,
                const std::string& description) {
  if (width < 1 || height < 1 || (bits != 8 && bits != 16) ||
      components.size() != 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
    throw std::invalid_argument(
        fmt::format("a PNG of {} x {} pixels with 3 x {} bits cannot be made from {} components", width,
                    height, bits, components.size()));
  const Bytes rows =
      rows_of(static_cast<std::size_t>(width), static_cast<std::size_t>(height), components.data(), bits);
  constexpr std::size_t longest_chunk = 0x7fffffff;
  constexpr int fastest = 1;
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(fastest), &libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  const std::size_t most = libdeflate_zlib_compress_bound(compressor.get(), rows.size());
  if (most > longest_chunk)
    throw std::invalid_argument(fmt::format("a PNG of {} x {} pixels is too large", width, height));
  Bytes png;
  append(png, std::string_view("\x89PNG\r\n\x1a\n"));
  std::size_t chunk = begin_chunk(png, "IHDR");
  append(png, static_cast<std::uint32_t>(width));
  append(png, static_cast<std::uint32_t>(height));
  constexpr unsigned char rgb = 2, deflated = 0, adaptive_filters = 0, not_interlaced = 0;
  png.insert(png.end(), {static_cast<unsigned char>(bits), rgb, deflated, adaptive_filters, not_interlaced});
  end_chunk(png, chunk);
  if (!description.empty()) {
    chunk = begin_chunk(png, "tEXt");
    append(png, std::string_view("Description\0", 12));
    append(png, shown(description));
    end_chunk(png, chunk);
  }
  chunk = begin_chunk(png, "IDAT");
  const std::size_t begin = png.size();
  png.resize(begin + most);
  png.resize(begin + libdeflate_zlib_compress(compressor.get(), rows.data(), rows.size(), png.data() + begin,
                                              png.size() - begin));
  end_chunk(png, chunk);
  end_chunk(png, begin_chunk(png, "IEND"));
  return png;
}

}  // namespace tubefoot
