// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/bags/byte_source.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace tubefoot {

ByteSource::ByteSource(const std::filesystem::path& file)
    : place_{file.string(), 0, 0}, file_(std::make_unique<InputFile>(file)) {}

ByteSource::ByteSource(const std::filesystem::path& file, std::vector<std::uint8_t> bytes)
    : place_{file.string(), 0, 0}, memory_(std::move(bytes)) {}

void ByteSource::read(std::uint64_t at, std::span<std::uint8_t> bytes) {
  if (at > size() || bytes.size() > size() - at)
    throw InputError(place_, fmt::format("ends before byte {}: it is cut off", at + bytes.size()));
  if (!file_) {
    std::copy_n(memory_.begin() + static_cast<std::ptrdiff_t>(at), bytes.size(), bytes.begin());
    return;
  }
  std::istream& in = file_->stream();
  in.clear();
  in.seekg(static_cast<std::streamoff>(at));
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::size_t>(in.gcount()) != bytes.size())
    throw InputError(place_, fmt::format("reading failed at byte {}: is a program writing the file?", at));
}

std::vector<std::uint8_t> ByteSource::read(std::uint64_t at, std::uint64_t count) {
  if (at > size() || count > size() - at)
    throw InputError(place_, fmt::format("ends before byte {}: it is cut off", at + count));
  std::vector<std::uint8_t> bytes(count);
  read(at, bytes);
  return bytes;
}

}  // namespace tubefoot
