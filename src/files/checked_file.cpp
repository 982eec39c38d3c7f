// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/checked_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

namespace tubefoot {

void write_file(const std::filesystem::path& file, std::span<const unsigned char> bytes) {
  const auto fail = [&](int cause) {
    throw std::runtime_error(
        fmt::format("{}: cannot write the file: {}", file.string(), std::strerror(cause)));
  };
  std::FILE* stream = std::fopen(file.c_str(), "wb");
  if (!stream) fail(errno);
  int cause = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), stream) != bytes.size()) cause = errno;
  if (std::fclose(stream) != 0 && cause == 0) cause = errno;
  if (cause == 0) return;
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file, ignored))
    std::filesystem::remove(file, ignored);  // never a device
  fail(cause);
}

}  // namespace tubefoot
