// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/temporary_buffer.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "files/checked_file.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t most_in_memory = std::size_t{1} << 20;

}  // namespace

TemporaryBuffer::~TemporaryBuffer() {
  if (file_ != nullptr) std::fclose(file_);
}

TemporaryBuffer::TemporaryBuffer(TemporaryBuffer&& other) noexcept
    : beside_(std::move(other.beside_)),
      memory_(std::move(other.memory_)),
      file_(std::exchange(other.file_, nullptr)),
      on_disk_(std::exchange(other.on_disk_, 0)) {}

void TemporaryBuffer::fail() const { throw write_error(beside_, errno); }

void TemporaryBuffer::add(const void* bytes, std::size_t count) {
  memory_.append(static_cast<const char*>(bytes), count);
  if (memory_.size() > most_in_memory) flush();
}

void TemporaryBuffer::flush() {
  if (file_ == nullptr) {
    std::string name = beside_.string() + ".XXXXXX";
    const int descriptor = mkostemp(name.data(), O_CLOEXEC);
    if (descriptor < 0) fail();
    unlink(name.c_str());
    file_ = fdopen(descriptor, "w+b");
    if (file_ == nullptr) {
      close(descriptor);
      fail();
    }
  }
  if (std::fwrite(memory_.data(), 1, memory_.size(), file_) != memory_.size() || std::fflush(file_) != 0)
    fail();
  on_disk_ += memory_.size();
  memory_.clear();
}

void TemporaryBuffer::read(std::uint64_t first, void* bytes, std::size_t count) const {
  if (first > size() || count > size() - first)
    throw std::out_of_range("bytes beyond the end of a temporary buffer");
  auto* to = static_cast<char*>(bytes);
  while (count > 0 && first < on_disk_) {
    const ssize_t got =
        pread(fileno(file_), to, std::min<std::uint64_t>(count, on_disk_ - first), static_cast<off_t>(first));
    if (got < 0 && errno == EINTR) continue;
    if (got == 0) errno = EIO;
    if (got <= 0) fail();
    to += got, first += static_cast<std::uint64_t>(got), count -= static_cast<std::size_t>(got);
  }
  if (count > 0) std::memcpy(to, memory_.data() + (first - on_disk_), count);
}

void TemporaryBuffer::replay(const std::function<void(std::span<const char>)>& take) {
  if (file_ != nullptr) {
    flush();
    if (std::fseek(file_, 0, SEEK_SET) != 0) fail();
    std::vector<char> block(most_in_memory);
    for (std::uint64_t left = on_disk_; left > 0;) {
      const std::size_t read =
          std::fread(block.data(), 1, std::min<std::uint64_t>(left, block.size()), file_);
      if (read == 0) fail();
      take(std::span(block).first(read));
      left -= read;
    }
  }
  take(memory_);
}

}  // namespace tubefoot
