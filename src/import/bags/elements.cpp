// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/bags/elements.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <stdexcept>

namespace tubefoot {
namespace {

/// Calls `use` with a value of the C++ type.
template <class Use>
auto with(ElementType type, const Use& use) {
  switch (type) {
    case ElementType::u8:
      return use(std::uint8_t{});
    case ElementType::i8:
      return use(std::int8_t{});
    case ElementType::u16:
      return use(std::uint16_t{});
    case ElementType::i16:
      return use(std::int16_t{});
    case ElementType::u32:
      return use(std::uint32_t{});
    case ElementType::i32:
      return use(std::int32_t{});
    case ElementType::u64:
      return use(std::uint64_t{});
    case ElementType::i64:
      return use(std::int64_t{});
    case ElementType::f32:
      return use(float{});
    case ElementType::f64:
      return use(double{});
  }
  throw std::logic_error("unknown type of elements");
}

}  // namespace

std::size_t bytes_of(ElementType type) {
  return with(type, [](auto number) { return sizeof number; });
}

std::string_view name_of(ElementType type) {
  constexpr std::array<std::string_view, element_types> names{
      "uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32", "float64"};
  return names[static_cast<std::size_t>(type)];
}

void append_elements(ElementType type, bool big_endian, std::span<const std::uint8_t> bytes,
                     std::vector<double>& values) {
  const bool turned = big_endian != (std::endian::native == std::endian::big);
  with(type, [&](auto number) {
    using Number = decltype(number);
    values.reserve(values.size() + bytes.size() / sizeof number);
    for (std::size_t at = 0; at + sizeof number <= bytes.size(); at += sizeof number) {
      std::array<std::uint8_t, sizeof number> raw;
      std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), sizeof number, raw.begin());
      if (turned) std::ranges::reverse(raw);
      values.push_back(static_cast<double>(std::bit_cast<Number>(raw)));
    }
  });
}

}  // namespace tubefoot
