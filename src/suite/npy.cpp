// SPDX-License-Identifier: GPL-3.0-or-later
#include "suite/npy.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <string>

#include "files/checked_file.hpp"

namespace tubefoot {

void write_npy(const std::filesystem::path& file, std::array<std::size_t, 3> shape,
               std::span<const double> values) {
  std::string header = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, {}, {}), }}",
                                   shape[0], shape[1], shape[2]);
  // Magic, version and length take ten bytes. The values begin at a multiple of 64 bytes.
  constexpr std::size_t before = 10, multiple = 64;
  header.resize((before + header.size() + 1 + multiple - 1) / multiple * multiple - before - 1, ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 0xff);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  bytes.reserve(bytes.size() + 8 * values.size());
  for (const double value : values) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int k = 0; k < 8; ++k) bytes += static_cast<char>(bits >> (8 * k) & 0xff);
  }
  write_file(file, bytes);
}

}  // namespace tubefoot
