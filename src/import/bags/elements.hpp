// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace tubefoot {

/// Types of numbers, in the order of the constants of SonarImageData.
enum class ElementType : std::uint32_t { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64 };
inline constexpr std::uint32_t element_types = 10;

std::size_t bytes_of(ElementType type);
/// Returns the name, for example "uint8".
std::string_view name_of(ElementType type);
/// Appends the numbers in `bytes`, which must contain whole elements.
void append_elements(ElementType type, bool big_endian, std::span<const std::uint8_t> bytes,
                     std::vector<double>& values);

}  // namespace tubefoot
