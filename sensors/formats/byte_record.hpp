// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace tubefoot {

/// A record of fixed size, all zero at first, that is filled by byte offset as the tables of a file format
/// give it: little-endian, without alignment, on any machine. Fields may be put again. A field that does not
/// fit the record throws std::out_of_range: the offset is wrong.
class ByteRecord {
 public:
  explicit ByteRecord(std::size_t size) : bytes_(size) {}

  void put_u8(std::size_t offset, std::uint8_t value) { put(offset, value); }
  void put_u16(std::size_t offset, std::uint16_t value) { put(offset, value); }
  void put_u32(std::size_t offset, std::uint32_t value) { put(offset, value); }
  void put_u64(std::size_t offset, std::uint64_t value) { put(offset, value); }
  void put_i32(std::size_t offset, std::int32_t value) { put(offset, static_cast<std::uint32_t>(value)); }
  /// IEEE single precision, rounded to nearest; the value must lie within its range.
  void put_f32(std::size_t offset, double value) {
    put(offset, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
  }
  void put_f64(std::size_t offset, double value) { put(offset, std::bit_cast<std::uint64_t>(value)); }

  /// A field of `size` bytes, zero-padded and always zero-terminated: longer text is cut, never inside an
  /// UTF-8 character.
  void put_text(std::size_t offset, std::size_t size, std::string_view text) {
    const auto field = at(offset, size);
    std::size_t length = text.size();
    if (length >= size)
      for (length = size - 1; length > 0 && (text[length] & 0xC0) == 0x80;) --length;
    for (std::size_t i = 0; i < size; ++i) field[i] = i < length ? static_cast<std::uint8_t>(text[i]) : 0;
  }

  std::span<const std::uint8_t> bytes() const { return bytes_; }

 private:
  std::span<std::uint8_t> at(std::size_t offset, std::size_t size) {
    if (size > bytes_.size() || offset > bytes_.size() - size)
      throw std::out_of_range("a field lies outside of its record");
    return std::span(bytes_).subspan(offset, size);
  }

  template <std::unsigned_integral Integer>
  void put(std::size_t offset, Integer value) {
    const auto field = at(offset, sizeof value);
    for (std::size_t i = 0; i < sizeof value; ++i)
      field[i] = static_cast<std::uint8_t>(std::uint64_t{value} >> (8 * i));
  }

  std::vector<std::uint8_t> bytes_;
};

}  // namespace tubefoot
