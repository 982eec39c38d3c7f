// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/base64.hpp"

#include <cstdint>

namespace tubefoot {

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return i + k < bytes.size() ? std::uint32_t(static_cast<unsigned char>(bytes[i + k])) : 0u;
    };
    const std::uint32_t three = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (int k = 0; k < 4; ++k)
      text += std::size_t(k) > bytes.size() - i ? '=' : digits[three >> (18 - 6 * k) & 63];
  }
  return text;
}

}  // namespace tubefoot
