// SPDX-License-Identifier: GPL-3.0-or-later

// Opens regular files for reading and reads them in pieces. It detects files that are not regular and files
// that grow during reading, as those of /proc do.

#include "files/input_registry.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ext/stdio_filebuf.h>

#include "geometry/steps/steps.hpp"

namespace tubefoot {

namespace fs = std::filesystem;

struct InputFile::Buffer : __gnu_cxx::stdio_filebuf<char> {
  using stdio_filebuf::stdio_filebuf;
  int fd() const { return const_cast<Buffer*>(this)->stdio_filebuf::fd(); }
};

InputFile::InputFile(const fs::path& file) : InputFile(file, {file.string(), 0, 0}) {}

InputFile::InputFile(fs::path file, const SourcePlace& place, std::string_view expected)
    : path_(std::move(file)), place_(place) {
  const std::string name = place.file == path_.string() ? "" : fmt::format("'{}' ", path_.string());
  // A non-blocking open does not wait for the writer of a pipe. A file that is not regular is never read.
  const int descriptor = open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0)
    throw InputError(
        place_, errno == EACCES
                    ? fmt::format("{}is not readable ({}): change its permissions, or those of its folders",
                                  name, std::strerror(errno))
                    : fmt::format("{}cannot be opened ({}): check the path and the permissions", name,
                                  std::strerror(errno)));
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    close(descriptor);
    throw InputError(place_, fmt::format("{}is {}, expected {}", name,
                                         S_ISDIR(status.st_mode) ? "a folder" : "a special file", expected));
  }
  size_ = static_cast<std::uintmax_t>(status.st_size);
  buffer_ = std::make_unique<Buffer>(descriptor, std::ios::in | std::ios::binary);
  stream_ = std::make_unique<std::istream>(buffer_.get());
}

InputFile::~InputFile() = default;

int InputFile::descriptor() const { return buffer_->fd(); }

std::string InputFile::head(std::size_t most) {
  const std::istream::pos_type here = stream_->tellg();
  std::string bytes(most, '\0');
  stream_->read(bytes.data(), static_cast<std::streamsize>(most));
  bytes.resize(static_cast<std::size_t>(stream_->gcount()));
  stream_->clear();
  stream_->seekg(here);
  return bytes;
}

void InputFile::for_each_piece(const std::function<void(std::string_view)>& use) {
  std::string piece(std::size_t{1} << 20, '\0');
  std::uintmax_t left = size_;
  Steps read("MiB read", size_ / piece.size());
  while (*stream_) {
    read.done();
    stream_->read(piece.data(), static_cast<std::streamsize>(piece.size()));
    const auto count = static_cast<std::size_t>(stream_->gcount());
    // Files of the system (/proc) report the size 0 and may be endless.
    if (count > left)
      throw InputError(place_, fmt::format("'{}' has more than the {} bytes that it had when it was opened: "
                                           "it is not a regular file, or a program is writing it",
                                           path_.string(), size_));
    left -= count;
    use(std::string_view(piece).substr(0, count));
  }
  if (!stream_->eof())
    throw InputError(place_, fmt::format("reading '{}' failed before the end of the file", path_.string()));
}

std::optional<FileState> state_of(const fs::path& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) return std::nullopt;
  return FileState{static_cast<std::int64_t>(status.st_dev), static_cast<std::int64_t>(status.st_ino),
                   status.st_size, status.st_mtim.tv_sec, status.st_mtim.tv_nsec};
}

std::string read_whole(const fs::path& file, const SourcePlace& place, std::uintmax_t most,
                       std::string_view expected) {
  InputFile input(file, place, expected);
  std::string text;
  input.for_each_piece([&](std::string_view piece) {
    text += piece;
    if (text.size() > most)
      throw InputError(place, fmt::format("is larger than {} bytes, expected {}", most, expected));
  });
  return text;
}

}  // namespace tubefoot
