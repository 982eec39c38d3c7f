// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/checkpoint/part_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <libdeflate.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "files/absolute_path.hpp"
#include "files/durable.hpp"

// This file reads and writes the file of one shard. It consists of a header, the identity of the run as
// text, and packed pings in the order of completion.

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Start of a file. The text of the identity follows, and then the pings.
struct Header {
  char magic[16] = {'t', 'u', 'b', 'e', 'f', 'o', 'o', 't', ' ', 'p', 'a', 'r', 't', ' ', ' ', '1'};
  std::uint64_t identity_bytes = 0, identity_checksum = 0;
};

// Much more than the settings of any scene.
constexpr std::uint64_t most_identity_bytes = std::uint64_t{1} << 20;

std::uint64_t checksum_of(const std::string& text) { return libdeflate_crc32(0, text.data(), text.size()); }

[[noreturn]] void fail(const fs::path& file, const char* task, int error) {
  throw std::runtime_error(fmt::format("{}: cannot {}: {}", file.string(), task, std::strerror(error)));
}

/// Returns whether the file contains `count` bytes at the offset, and reads them.
bool read_at(const Descriptor& file, std::uint64_t offset, void* bytes, std::size_t count) {
  for (auto* to = static_cast<char*>(bytes); count > 0;) {
    const ssize_t got = pread(file.number(), to, count, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    to += got;
    offset += static_cast<std::uint64_t>(got);
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

std::uint64_t size_of(const Descriptor& file) {
  struct stat status {};
  return fstat(file.number(), &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

}  // namespace

PartFile::PartFile(fs::path file) : path_(std::move(file)), file_(take_ping_file(path_, false)) {
  if (!file_) return;
  const auto unusable = [&](const char* why) {
    return UnusableStore(fmt::format("'{}' {}", path_.string(), why));
  };
  const std::uint64_t size = size_of(file_);
  if (size == 0) return;
  Header header;
  if (!read_at(file_, 0, &header, sizeof header) ||
      std::memcmp(header.magic, Header{}.magic, sizeof header.magic) != 0)
    throw unusable("is not a shard of this version of tubefoot");
  if (header.identity_bytes > most_identity_bytes) throw unusable("is damaged");
  // the run was killed before it wrote the identity
  if (header.identity_bytes > size - sizeof header) return;
  identity_.resize(header.identity_bytes);
  if (!read_at(file_, sizeof header, identity_.data(), identity_.size())) throw unusable("cannot be read");
  if (checksum_of(identity_) != header.identity_checksum) throw unusable("is damaged");
  end_ = sizeof header + identity_.size();
}

bool PartFile::has_pings() const {
  return !identity_.empty() && size_of(file_) > sizeof(Header) + identity_.size();
}

void PartFile::begin(const std::string& identity) {
  if (!file_) file_ = take_ping_file(path_, true);
  if (identity_.empty()) {
    try {
      begin_anew(identity);
    } catch (...) {
      fs::remove(path_);
      throw;
    }
    // removes a ping that was only partly written
  } else if (ftruncate(file_.number(), static_cast<off_t>(end_)) != 0) {
    fail(path_, "write the part", errno);
  }
}

void PartFile::begin_anew(const std::string& identity) {
  Header header;
  header.identity_bytes = identity.size();
  header.identity_checksum = checksum_of(identity);
  end_ = 0;
  if (ftruncate(file_.number(), 0) != 0) fail(path_, "write the part", errno);
  write(std::string(reinterpret_cast<const char*>(&header), sizeof header) + identity);
  identity_ = identity;
  sync();
  sync_names_in(absolute_path(path_).parent_path());
}

void PartFile::look_through(const StoreLayout& layout) {
  first_unit_.clear();
  for (std::size_t unit = 0; const StoreLayout::Group& group : layout.groups) {
    first_unit_.push_back(unit);
    unit += group.pings;
  }
  places_.assign(layout.units(), {});
  if (identity_.empty()) return;
  const std::uint64_t size = size_of(file_);
  end_ = sizeof(Header) + identity_.size();
  std::string values;
  while (true) {
    std::string bytes(sizeof(PackedHead), '\0');
    if (!read_at(file_, end_, bytes.data(), bytes.size())) return;
    PackedHead head;
    try {
      head = head_of_packed(bytes, layout);
    } catch (const DamagedPing&) {
      return;  // the position of the next ping is unknown
    }
    if (head.bytes > size - end_ - sizeof head) return;
    values.resize(head.bytes);
    const bool whole =
        read_at(file_, end_ + sizeof head, values.data(), values.size()) && belongs_to(head, values);
    Place& place = places_[first_unit_[head.unit.group] + head.unit.ping];
    if (whole)
      place = {end_, sizeof head + head.bytes, State::whole};
    else if (place.state == State::missing)
      place.state = State::damaged;
    end_ += sizeof head + head.bytes;
  }
}

void PartFile::write(const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t put =
        pwrite(file_.number(), bytes.data() + done, bytes.size() - done, static_cast<off_t>(end_ + done));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) {
      const int cause = put < 0 ? errno : ENOSPC;
      // The result does not matter, because a partly written ping is also detected when the file is read.
      [[maybe_unused]] const int ignored = ftruncate(file_.number(), static_cast<off_t>(end_));
      fail(path_, "write the part", cause);
    }
    done += static_cast<std::size_t>(put);
  }
  end_ += bytes.size();
}

void PartFile::append(const std::string& packed) {
  constexpr std::chrono::seconds between_syncs{5};
  bool due = false;
  {
    const std::lock_guard lock(mutex_);
    write(packed);
    const auto now = std::chrono::steady_clock::now();
    due = now >= next_sync_;
    if (due) next_sync_ = now + between_syncs;
  }
  if (due) sync();
}

std::string PartFile::read(const PingUnit& unit) const {
  const Place& at = place(unit);
  std::string packed(at.bytes, '\0');
  if (at.state != State::whole || !read_at(file_, at.offset, packed.data(), packed.size()) ||
      std::memcmp(packed.data(), &unit, sizeof unit) != 0)
    throw DamagedPing("it cannot be read");
  return packed;
}

void PartFile::sync() const {
  if (!file_) return;
  int status = 0;
  do {
    status = fdatasync(file_.number());
  } while (status != 0 && errno == EINTR);
  if (status != 0) fail(path_, "write the shard to the disk", errno);
}

}  // namespace tubefoot
