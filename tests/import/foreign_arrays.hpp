// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

// Writes files of NumPy byte by byte from their specification: .npy arrays, and .npz archives with claimed
// sizes.
namespace tubefoot {

inline std::string npy_header(const std::string& type, const std::string& shape, bool fortran = false) {
  std::string dictionary = "{'descr': '" + type + "', 'fortran_order': " + (fortran ? "True" : "False") +
                           ", 'shape': " + shape + ", }";
  dictionary.resize((10 + dictionary.size() + 64) / 64 * 64 - 10 - 1, ' ');
  dictionary += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(dictionary.size() & 255);
  bytes += static_cast<char>(dictionary.size() >> 8);
  return bytes + dictionary;
}

inline std::string npy_of_shape(const std::string& type, const std::string& shape) {
  return npy_header(type, shape);
}

template <class Stored>
void append_stored(std::string& bytes, Stored value, bool big) {
  char own[sizeof(Stored)];
  std::memcpy(own, &value, sizeof value);
  if (big) std::reverse(own, own + sizeof own);
  bytes.append(own, sizeof own);
}

/// Bits of a half-precision number. The value is 0 or a positive number with an exact representation.
inline std::uint16_t half_bits(double value) {
  if (value == 0) return 0;
  const int exponent = std::ilogb(value);
  return static_cast<std::uint16_t>((exponent + 15) << 10 |
                                    static_cast<int>(std::ldexp(value, 10 - exponent) - 1024));
}

inline std::string npy_bytes(const std::string& type, const std::vector<std::size_t>& shape,
                             const std::vector<double>& values, bool fortran = false) {
  std::string lengths = "(";
  for (std::size_t k = 0; k < shape.size(); ++k)
    lengths += (k > 0 ? " " : "") + std::to_string(shape[k]) + (k + 1 < shape.size() || k == 0 ? "," : "");
  std::string bytes = npy_header(type, lengths + ")", fortran);
  const bool big = type[0] == '>';
  const std::string word = type.substr(1);
  for (const double value : values) {
    if (word == "f8" || word == "c16") append_stored(bytes, value, big);
    if (word == "f4" || word == "c8") append_stored(bytes, static_cast<float>(value), big);
    if (word == "f2") append_stored(bytes, half_bits(value), big);
    if (word == "i1") append_stored(bytes, static_cast<std::int8_t>(value), big);
    if (word == "u1") append_stored(bytes, static_cast<std::uint8_t>(value), big);
    if (word == "i2") append_stored(bytes, static_cast<std::int16_t>(value), big);
    if (word == "u2") append_stored(bytes, static_cast<std::uint16_t>(value), big);
    if (word == "i4") append_stored(bytes, static_cast<std::int32_t>(value), big);
    if (word == "u8") append_stored(bytes, static_cast<std::uint64_t>(value), big);
  }
  return bytes;
}

/// CRC-32 of ISO 3309, as in ZIP.
inline std::uint32_t crc32_of(const std::string& bytes) {
  std::uint32_t crc = ~0u;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int k = 0; k < 8; ++k) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  return ~crc;
}

struct ZipMember {
  std::string name, bytes;
  std::uint32_t claimed = 0;  ///< claimed unpacked bytes; 0: the actual number, stored without compression
};

/// A ZIP archive of stored files (APPNOTE 6.3).
inline std::string zip_bytes(const std::vector<ZipMember>& members) {
  std::string all, directory;
  for (const auto& [name, bytes, claimed] : members) {
    std::string common;
    const auto put = [&](std::string& to, auto value) { append_stored(to, value, false); };
    put(common, std::uint16_t{20}), put(common, std::uint16_t{0});
    put(common, static_cast<std::uint16_t>(claimed ? 8 : 0)), put(common, std::uint32_t{0x00210000});
    put(common, crc32_of(bytes)), put(common, static_cast<std::uint32_t>(bytes.size()));
    put(common, claimed ? claimed : static_cast<std::uint32_t>(bytes.size()));
    put(common, static_cast<std::uint16_t>(name.size())), put(common, std::uint16_t{0});
    directory += std::string("PK\1\2\24\0", 6) + common + std::string(10, '\0');
    put(directory, static_cast<std::uint32_t>(all.size()));
    directory += name;
    all += "PK\3\4" + common + name + bytes;
  }
  const auto start = static_cast<std::uint32_t>(all.size());
  all += directory + std::string("PK\5\6\0\0\0\0", 8);
  const auto count = static_cast<std::uint16_t>(members.size());
  append_stored(all, count, false), append_stored(all, count, false);
  append_stored(all, static_cast<std::uint32_t>(directory.size()), false);
  append_stored(all, start, false), append_stored(all, std::uint16_t{0}, false);
  return all;
}

inline std::string npz_bytes(const std::vector<std::pair<std::string, std::string>>& arrays) {
  std::vector<ZipMember> members;
  for (const auto& [name, bytes] : arrays) members.push_back({name + ".npy", bytes});
  return zip_bytes(members);
}

/// Claims 4 GB for ten bytes.
inline std::string bursting_npz() { return zip_bytes({{"image.npy", "0123456789", 0xfffffff0u}}); }

}  // namespace tubefoot
