// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace tubefoot {

/// SHA-256 of a stream of bytes (FIPS 180-4). Own code because none of the libraries that tubefoot links
/// offers it in a public header.
class Sha256 {
 public:
  void update(std::string_view bytes);
  /// The digest of everything so far, 64 lower-case hexadecimal digits. More bytes may follow.
  std::string hex_digest() const;

 private:
  static constexpr std::size_t block_bytes = 64;

  void absorb(const unsigned char* block);

  /// First 32 bits of the fractional parts of the square roots of the first eight primes.
  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<unsigned char, block_bytes> block_{};
  std::size_t filled_ = 0;  ///< bytes waiting in block_
  std::uint64_t bytes_ = 0;
};

}  // namespace tubefoot
