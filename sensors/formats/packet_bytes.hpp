// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

// Common parts of the writers of packet formats (XTF, Reson, GSF, DIDSON, ARIS). They are bytes of a stated
// order at stated offsets, and the conversion of physical values to the fields of a packet.
namespace tubefoot {

/// The bytes of one packet. Callers always write out the type of a field, `put<std::uint16_t>(4, ...)`, so
/// that a reader can compare the line with the format's table.
class PacketBytes {
 public:
  explicit PacketBytes(std::endian order, std::size_t size = 0) : order_(order), bytes_(size, 0) {}

  std::size_t size() const { return bytes_.size(); }
  std::span<const unsigned char> bytes() const { return bytes_; }

  /// Overwrites a field, which must lie within the packet (std::out_of_range).
  template <typename Field>
  void put(std::size_t offset, std::type_identity_t<Field> value) {
    const auto field = encoded<Field>(value);
    for (std::size_t k = field.size(); k-- > 0;) bytes_.at(offset + k) = field[k];
  }
  /// IEEE single precision, rounded to nearest; the value must be within its range.
  void put_single(std::size_t offset, double value) { put<float>(offset, static_cast<float>(value)); }
  template <typename Field>
  void append(std::type_identity_t<Field> value) {
    const auto field = encoded<Field>(value);
    bytes_.insert(bytes_.end(), field.begin(), field.end());
  }
  void append(std::span<const unsigned char> more) { bytes_.insert(bytes_.end(), more.begin(), more.end()); }
  void append_zeros(std::size_t count) { bytes_.insert(bytes_.end(), count, 0); }
  void pad_to_multiple_of(std::size_t block) { append_zeros((block - bytes_.size() % block) % block); }
  void put_text(std::size_t offset, std::string_view text) {
    for (std::size_t k = 0; k < text.size(); ++k) bytes_.at(offset + k) = static_cast<unsigned char>(text[k]);
  }
  /// A field of `size` bytes, padded and always terminated with zeros. Longer text is cut, but never inside
  /// a UTF-8 character.
  void put_text(std::size_t offset, std::size_t size, std::string_view text) {
    std::size_t length = text.size();
    if (length >= size)
      for (length = size - 1; length > 0 && (text[length] & 0xC0) == 0x80;) --length;
    for (std::size_t k = size; k-- > 0;)
      bytes_.at(offset + k) = k < length ? static_cast<unsigned char>(text[k]) : 0;
  }

 private:
  template <typename Field>
  std::array<unsigned char, sizeof(Field)> encoded(Field value) const {
    auto field = std::bit_cast<std::array<unsigned char, sizeof(Field)>>(value);
    if (order_ != std::endian::native)
      for (std::size_t k = 0; k < field.size() / 2; ++k) std::swap(field[k], field[field.size() - 1 - k]);
    return field;
  }

  std::endian order_;
  std::vector<unsigned char> bytes_;
};

/// Converts physical values to fields. Each function throws std::invalid_argument for a value out of range;
/// the message names the position, the value and the accepted range.
class FieldCheck {
 public:
  /// `where` begins every message: the file, the packet and its number.
  explicit FieldCheck(std::string where) : where_(std::move(where)) {}

  /// The integer nearest to value * per_unit, if Field can represent it.
  template <std::integral Field>
  Field integer(std::string_view name, double value, double per_unit = 1) const {
    using Limits = std::numeric_limits<Field>;
    const double scaled = std::round(value * per_unit);
    if (!(scaled >= double(Limits::min()) && scaled <= double(Limits::max())))
      refuse(name, value, double(Limits::min()) / per_unit, double(Limits::max()) / per_unit);
    return static_cast<Field>(scaled);
  }
  /// A finite number within the range of a 32-bit float.
  float real(std::string_view name, double value) const {
    constexpr double largest = std::numeric_limits<float>::max();
    return static_cast<float>(within(name, value, -largest, largest));
  }
  /// The value itself, if lowest <= value <= highest.
  double within(std::string_view name, double value, double lowest, double highest) const {
    if (!(value >= lowest && value <= highest)) refuse(name, value, lowest, highest);
    return value;
  }
  /// The value itself, if it is above 0 and finite.
  double positive(std::string_view name, double value) const {
    if (!(value > 0 && std::isfinite(value)))
      throw std::invalid_argument(
          fmt::format("{}: {} is {}, but must be above 0 and finite", where_, name, value));
    return value;
  }
  /// The text itself, if it fits with the terminating zero that readers expect.
  const std::string& text(std::string_view name, const std::string& value, std::size_t capacity) const {
    if (value.size() >= capacity || value.find('\0') != std::string::npos)
      throw std::invalid_argument(
          fmt::format("{}: {} '{}' has {} bytes, but must have at most {} and no zero byte", where_, name,
                      value, value.size(), capacity - 1));
    return value;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw std::invalid_argument(fmt::format("{}: {}", where_, what));
  }

 private:
  [[noreturn]] void refuse(std::string_view name, double value, double lowest, double highest) const {
    throw std::invalid_argument(
        fmt::format("{}: {} is {}, but must be from {} to {}", where_, name, value, lowest, highest));
  }

  std::string where_;
};

}  // namespace tubefoot
