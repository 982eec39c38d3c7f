// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/streamed_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <stdexcept>
#include <utility>

#include "files/checked_file.hpp"

namespace tubefoot {

StreamedFile::StreamedFile(std::filesystem::path file)
    : path_(std::move(file)), stream_(std::fopen(path_.c_str(), "wb")) {
  if (!stream_) fail(errno);
}

StreamedFile::~StreamedFile() { discard(); }

void StreamedFile::append(std::span<const std::uint8_t> bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), open_stream()) != bytes.size()) fail(errno);
  size_ += bytes.size();
}

void StreamedFile::append(std::string_view text) {
  append({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

void StreamedFile::overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes) {
  if (offset + bytes.size() > size_)
    throw std::logic_error(fmt::format("{}: cannot overwrite bytes {} to {}, which are beyond the end",
                                       path_.string(), offset, offset + bytes.size()));
  if (std::fseek(open_stream(), static_cast<long>(offset), SEEK_SET) != 0) fail(errno);
  if (std::fwrite(bytes.data(), 1, bytes.size(), stream_) != bytes.size()) fail(errno);
  if (std::fseek(stream_, 0, SEEK_END) != 0) fail(errno);
}

void StreamedFile::close() {
  std::FILE* stream = open_stream();
  stream_ = nullptr;
  if (std::fclose(stream) == 0) return;
  const int cause = errno;
  discard_file(path_);
  fail(cause);
}

std::FILE* StreamedFile::open_stream() const {
  if (!stream_)
    throw std::logic_error(fmt::format("{}: the file is no longer being written", path_.string()));
  return stream_;
}

void StreamedFile::fail(int cause) {
  discard();
  throw write_error(path_, cause);
}

void StreamedFile::discard() {
  if (!stream_) return;
  std::fclose(stream_);
  stream_ = nullptr;
  discard_file(path_);
}

}  // namespace tubefoot
