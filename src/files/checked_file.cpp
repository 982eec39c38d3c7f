// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/checked_file.hpp"

#include <fmt/format.h>

#include <cstring>

#include "files/staging.hpp"
#include "files/streamed_file.hpp"

namespace tubefoot {

namespace fs = std::filesystem;

std::runtime_error write_error(const fs::path& file, const std::string& what) {
  return std::runtime_error(fmt::format("{}: {}", final_name(file).string(), what));
}

std::runtime_error write_error(const fs::path& file, int cause) {
  return write_error(file, std::string("cannot write the file: ") + std::strerror(cause));
}

void write_file(const fs::path& file, std::span<const unsigned char> bytes) {
  StreamedFile stream(file);
  stream.append(bytes);
  stream.close();
}

void write_file(const fs::path& file, std::string_view text) {
  write_file(file, {reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

void discard_file(const fs::path& file) {
  std::error_code ignored;
  if (fs::is_regular_file(fs::symlink_status(file, ignored))) fs::remove(file, ignored);
}

}  // namespace tubefoot
