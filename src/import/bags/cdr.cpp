// SPDX-License-Identifier: GPL-3.0-or-later
// Reads messages in plain CDR (XCDR1) of either byte order. The four bytes of the encapsulation header of
// OMG DDSI-RTPS, section 10, select the byte order. Numbers are aligned to multiples of their size.
#include "import/bags/cdr.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>

#include "import/bags/message_error.hpp"

namespace tubefoot {
namespace {

/// OMG DDSI-RTPS, section 10: two bytes identify the serialization, two are options.
constexpr std::size_t encapsulation = 4;

class CdrReader {
 public:
  CdrReader(std::span<const std::uint8_t> body, std::endian order) : body_(body), order_(order) {}

  template <class T>
  void operator()(const char* name, T& value) {
    const std::size_t before = field_.size();
    field_ += (field_.empty() ? "" : ".") + std::string(name);
    read(value);
    field_.resize(before);
  }

  std::size_t left() const { return body_.size() - at_; }

 private:
  template <class T>
  void read(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      const std::uint8_t byte = take(1).front();
      if (byte > 1) fail(fmt::format("is {}, expected 0 or 1", byte));
      value = byte == 1;
    } else if constexpr (std::is_arithmetic_v<T>) {
      value = number<T>();
    } else if constexpr (std::is_same_v<T, std::string>) {
      read_text(value);
    } else if constexpr (ros::is_list<T>) {
      read_list(value);
    } else {
      fields(*this, value);
    }
  }

  /// Skips padding. Numbers lie at multiples of their size, counted from the end of the encapsulation.
  void align(std::size_t size) {
    const std::size_t gap = (size - at_ % size) % size;
    take(gap);
  }

  std::span<const std::uint8_t> take(std::uint64_t count) {
    if (count > left())
      fail(fmt::format("needs {} bytes, but {} are left: the message is cut off", count, left()));
    const auto front = body_.subspan(at_, count);
    at_ += count;
    return front;
  }

  template <class T>
  T number() {
    align(sizeof(T));
    std::array<std::uint8_t, sizeof(T)> bytes;
    std::ranges::copy(take(sizeof(T)), bytes.begin());
    if (order_ != std::endian::native) std::ranges::reverse(bytes);
    return std::bit_cast<T>(bytes);
  }

  void read_text(std::string& value) {
    const auto length = number<std::uint32_t>();
    const auto bytes = take(length);
    if (length == 0) return value.clear();  // not permitted by the standard, but some writers do it
    if (bytes.back() != 0) fail("is a text that does not end with a zero byte");
    value.assign(reinterpret_cast<const char*>(bytes.data()), length - 1);
  }

  template <class T>
  void read_list(std::vector<T>& list) {
    const auto count = number<std::uint32_t>();
    if (count == 0) return list.clear();
    if constexpr (std::is_arithmetic_v<T>) {
      align(sizeof(T));
      const auto bytes = take(std::uint64_t{count} * sizeof(T));
      list.resize(count);
      std::memcpy(list.data(), bytes.data(), bytes.size());
      if (order_ != std::endian::native && sizeof(T) > 1)
        for (T& value : list) {
          auto raw = std::bit_cast<std::array<std::uint8_t, sizeof(T)>>(value);
          std::ranges::reverse(raw);
          value = std::bit_cast<T>(raw);
        }
    } else {
      static_assert(std::is_same_v<T, ros::Vector3>);  // the code below requires its size
      if (std::uint64_t{count} * sizeof(T) > left())
        fail(fmt::format("has {} entries, but {} bytes are left: the message is cut off", count, left()));
      list.resize(count);
      for (T& value : list) fields(*this, value);
    }
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw MessageError(fmt::format("{}: {}", field_, what));
  }

  std::span<const std::uint8_t> body_;
  std::endian order_;
  std::size_t at_ = 0;
  std::string field_;
};

}  // namespace

ros::Message read_cdr(std::string_view type, std::span<const std::uint8_t> bytes) {
  if (bytes.size() < encapsulation)
    throw MessageError(fmt::format(
        "{} bytes are too few for a message: CDR begins with a header of four bytes", bytes.size()));
  if (bytes[0] != 0 || bytes[1] > 1)
    throw MessageError(fmt::format(
        "begins with 0x{:02x}{:02x}, which is another serialization: expected plain CDR (0x0000 or 0x0001)",
        bytes[0], bytes[1]));
  CdrReader reader(bytes.subspan(encapsulation), bytes[1] == 1 ? std::endian::little : std::endian::big);
  ros::Message message = ros::message_of(type);
  std::visit([&reader](auto& filled) { fields(reader, filled); }, message);
  // Transports pad messages to whole words.
  constexpr std::size_t most_padding = 7;
  if (reader.left() > most_padding)
    throw MessageError(fmt::format(
        "{} bytes follow its last field: it was written with another definition of {}", reader.left(), type));
  return message;
}

}  // namespace tubefoot
