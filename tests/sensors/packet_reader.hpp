// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

// Reads binary packets by shifting bytes, apart from the writers, and keeps account of which bytes a test has
// looked at: what it has not looked at must be zero.
namespace tubefoot::samples {

inline std::vector<unsigned char> file_content(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot open " + file.string());
  return {std::istreambuf_iterator<char>(stream), {}};
}

class PacketReader {
 public:
  PacketReader(std::span<const unsigned char> bytes, bool big_endian)
      : bytes_(bytes.begin(), bytes.end()), seen_(bytes.size(), false), big_endian_(big_endian) {}

  std::size_t size() const { return bytes_.size(); }
  unsigned u8(std::size_t offset) { return static_cast<unsigned>(bits(offset, 1)); }
  unsigned u16(std::size_t offset) { return static_cast<unsigned>(bits(offset, 2)); }
  unsigned u32(std::size_t offset) { return static_cast<unsigned>(bits(offset, 4)); }
  int i8(std::size_t offset) { return static_cast<std::int8_t>(bits(offset, 1)); }
  int i16(std::size_t offset) { return static_cast<std::int16_t>(bits(offset, 2)); }
  int i32(std::size_t offset) { return static_cast<std::int32_t>(bits(offset, 4)); }
  float f32(std::size_t offset) { return std::bit_cast<float>(static_cast<std::uint32_t>(bits(offset, 4))); }
  double f64(std::size_t offset) { return std::bit_cast<double>(bits(offset, 8)); }
  /// Up to the first zero byte, one of which the field must have.
  std::string text(std::size_t offset, std::size_t capacity) {
    std::string value;
    for (std::size_t k = 0; k < capacity; ++k) value.push_back(static_cast<char>(bits(offset + k, 1)));
    const auto end = value.find('\0');
    if (end == std::string::npos) throw std::runtime_error("a text without an end");
    if (value.find_first_not_of('\0', end) != std::string::npos)
      throw std::runtime_error("text after its end");
    return value.substr(0, end);
  }
  std::vector<unsigned char> part(std::size_t begin, std::size_t size) {
    std::vector<unsigned char> result;
    for (std::size_t k = 0; k < size; ++k) result.push_back(static_cast<unsigned char>(u8(begin + k)));
    return result;
  }
  /// Offsets of bytes that are not zero and that nothing has read.
  std::vector<std::size_t> unread() const {
    std::vector<std::size_t> result;
    for (std::size_t k = 0; k < bytes_.size(); ++k)
      if (!seen_[k] && bytes_[k] != 0) result.push_back(k);
    return result;
  }

 private:
  std::uint64_t bits(std::size_t offset, std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const std::size_t from = big_endian_ ? k : size - 1 - k;
      value = value << 8 | bytes_.at(offset + from);
      seen_[offset + from] = true;
    }
    return value;
  }

  std::vector<unsigned char> bytes_;
  std::vector<bool> seen_;
  bool big_endian_;
};

}  // namespace tubefoot::samples
