// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/streamed_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace tubefoot {

StreamedFile::StreamedFile(std::filesystem::path path)
    : path_(std::move(path)), stream_(std::fopen(path_.c_str(), "wb")) {
  if (!stream_) fail(errno);
}

StreamedFile::~StreamedFile() { discard(); }

void StreamedFile::write(std::span<const unsigned char> bytes) {
  require_open();
  if (std::fwrite(bytes.data(), 1, bytes.size(), stream_) != bytes.size()) fail(errno);
}

void StreamedFile::finish() {
  require_open();
  if (std::fclose(std::exchange(stream_, nullptr)) == 0) return;
  const int cause = errno;
  remove_file();
  fail(cause);
}

void StreamedFile::require_open() const {
  if (!stream_)
    throw std::logic_error(
        fmt::format("{}: nothing can be written after the end or an error", path_.string()));
}

void StreamedFile::fail(int cause) {
  discard();
  throw std::runtime_error(
      fmt::format("{}: cannot write the file: {}", path_.string(), std::strerror(cause)));
}

void StreamedFile::discard() {
  if (!stream_) return;
  std::fclose(std::exchange(stream_, nullptr));
  remove_file();
}

void StreamedFile::remove_file() const {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path_, ignored)) std::filesystem::remove(path_, ignored);
}

}  // namespace tubefoot
