// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/checkpoint/ping_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <libdeflate.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <set>
#include <system_error>
#include <utility>

#include "files/absolute_path.hpp"
#include "files/durable.hpp"
#include "files/reserved_space.hpp"
#include "files/staging.hpp"

// This file reads and writes files of packed pings. Such a file consists of a header, the identity of the run
// as text, and packed pings in the order of completion.

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Start of a file. The text of the identity follows, and then the pings.
struct PingFileHeader {
  char magic[16] = {'t', 'u', 'b', 'e', 'f', 'o', 'o', 't', ' ', 'p', 'i', 'n', 'g', 's', ' ', '6'};
  std::uint64_t identity_bytes = 0;
  std::uint32_t identity_checksum = 0, head_checksum = 0;
};

std::uint32_t checksum_of(const PingFileHeader& header) {
  return libdeflate_crc32(0, &header, offsetof(PingFileHeader, head_checksum));
}
std::uint32_t checksum_of(const std::string& text) { return libdeflate_crc32(0, text.data(), text.size()); }

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

/// Returns the offset of the next header of a packed ping at or after `offset`, or `size` if there is none.
std::uint64_t next_head(const Descriptor& file, std::uint64_t offset, std::uint64_t size) {
  constexpr std::uint64_t window = std::uint64_t{1} << 20;
  std::string bytes;
  for (; offset + sizeof(PackedHead) <= size; offset += window) {
    bytes.resize(std::min(size - offset, window + sizeof(PackedHead) - 1));
    if (!read_at(file, offset, bytes.data(), bytes.size())) return size;
    for (std::size_t at = 0; at + sizeof(PackedHead) <= bytes.size(); ++at)
      if (const auto head = intact_head(std::string_view(bytes).substr(at));
          head && head->bytes <= size - offset - at - sizeof *head)
        return offset + at;
  }
  return size;
}

/// Returns the owner of files that this process creates in a folder. On a file server this may be another
/// user.
uid_t owner_of_new_files(const fs::path& beside) {
  const Staging probe(beside, 0700);
  struct stat status {};
  return lstat(probe.path().c_str(), &status) == 0 ? status.st_uid : geteuid();
}

/// Throws UnusableStore unless this run may write to the file. A file that somebody else placed under this
/// name could make the run overwrite another file, or let others change its pings.
void require_own(const Descriptor& file, const fs::path& path, const std::string& kind) {
  struct stat status {};
  const std::string foreign =
      fstat(file.number(), &status) != 0 || !S_ISREG(status.st_mode)            ? "is not a " + kind
      : status.st_nlink > 1                                                     ? "has a second hard link"
      : status.st_uid != geteuid() && status.st_uid != owner_of_new_files(path) ? "belongs to another user"
                                                                                : "";
  if (!foreign.empty()) throw UnusableStore(fmt::format("'{}' {}", path.string(), foreign));
}

[[noreturn]] void cannot(const fs::path& file, const std::string& task, int error) {
  throw std::runtime_error(fmt::format("{}: cannot {}: {}", file.string(), task, std::strerror(error)));
}

/// Opens and locks a file of pings. With `make`, creates the file, which must not exist yet. Without `make`,
/// returns an empty descriptor if there is no file.
Descriptor taken(const fs::path& path, const std::string& kind, bool make) {
  constexpr int most_trials = 10;  // another run may be about to remove the file
  for (int trial = 0; trial < most_trials; ++trial) {
    Descriptor file = open_own(path, O_RDWR | (make ? O_CREAT | O_EXCL : 0));
    if (!file) {
      if (make && errno == EEXIST) throw StoreInUse(path);
      if (make) cannot(path, "create the " + kind, errno);
      if (errno == ENOENT) return file;
      throw UnusableStore(fmt::format("cannot open the {} '{}' ({})", kind, path.string(),
                                      errno == ELOOP ? "it is a symbolic link" : std::strerror(errno)));
    }
    require_own(file, path, kind);
    try {
      if (!take_lock(file)) throw StoreInUse(path);
    } catch (const std::system_error& error) {
      if (make) fs::remove(path);
      cannot(path, "lock the " + kind, error.code().value());
    }
    if (is_still_at(path, file)) return file;
  }
  throw StoreInUse(path);
}

}  // namespace

StoreInUse::StoreInUse(const fs::path& file)
    : UnusableStore(fmt::format("another run is writing '{}': choose another -o, or wait", file.string())) {}

PingFile::PingFile(fs::path file, std::string kind) : PingFile(file, kind, taken(file, kind, false)) {}

PingFile::PingFile(fs::path file, std::string kind, Descriptor opened)
    : path_(std::move(file)), kind_(std::move(kind)), file_(std::move(opened)) {
  if (!file_) return;
  const auto unusable = [&](const std::string& why) {
    return UnusableStore(fmt::format("'{}' {}", path_.string(), why));
  };
  const std::uint64_t size = size_of(file_);
  if (size == 0) return;  // the run was killed before it wrote the header
  PingFileHeader header;
  const bool whole = read_at(file_, 0, &header, sizeof header);
  if (!whole || std::memcmp(header.magic, PingFileHeader{}.magic, sizeof header.magic) != 0) {
    const std::string_view magic(header.magic, sizeof header.magic);
    const bool earlier =
        whole && (magic.starts_with("tubefoot pings ") || magic.starts_with("tubefoot part "));
    throw unusable(fmt::format("is not a {} of this version of tubefoot{}", kind_,
                               earlier ? ", but of another version, which can finish it" : ""));
  }
  if (header.head_checksum != checksum_of(header)) throw unusable("is damaged");
  // the run was killed before it wrote the identity
  if (header.identity_bytes > size - sizeof header) return;
  identity_.resize(header.identity_bytes);
  if (!read_at(file_, sizeof header, identity_.data(), identity_.size())) throw unusable("cannot be read");
  if (checksum_of(identity_) != header.identity_checksum) throw unusable("is damaged");
  first_record_ = end_ = sizeof header + identity_.size();
}

void PingFile::fail(const std::string& task, int error) const { cannot(path_, task, error); }

std::uint64_t PingFile::each_record(const std::function<void(std::uint64_t, const PackedHead&)>& visit,
                                    bool& unreadable) const {
  const std::uint64_t size = size_of(file_);
  std::uint64_t end = first_record_;
  for (std::uint64_t at = end; at + sizeof(PackedHead) <= size;) {
    std::string bytes(sizeof(PackedHead), '\0');
    if (!read_at(file_, at, bytes.data(), bytes.size())) break;
    const std::optional<PackedHead> head = intact_head(bytes);
    if (!head) {
      unreadable = true;
      at = next_head(file_, at + 1, size);
      continue;
    }
    if (head->bytes > size - at - sizeof *head) break;  // the run was killed while it wrote this ping
    visit(at, *head);
    end = at += sizeof *head + head->bytes;
  }
  return end;
}

std::size_t PingFile::pings() const {
  if (identity_.empty()) return 0;
  std::set<std::pair<std::uint64_t, std::uint64_t>> found;
  bool unreadable = false;
  each_record([&](std::uint64_t, const PackedHead& head) { found.emplace(head.unit.group, head.unit.ping); },
              unreadable);
  return found.size();
}

void PingFile::look_through(const StoreLayout& layout) {
  layout_ = layout;
  places_ = std::vector<Place>(layout.units());
  damaged_.assign(layout.units(), false);
  unreadable_ = false;
  if (identity_.empty()) return;
  const auto of_another_run = [&] {
    return UnusableStore(fmt::format("'{}' contains pings of another run", path_.string()));
  };
  std::string packed;
  end_ = each_record(
      [&](std::uint64_t at, const PackedHead& head) {
        if (head.unit.group >= layout.groups.size() ||
            head.unit.ping >= layout.groups[head.unit.group].pings ||
            head.bytes > most_packed(layout, head.unit.group))
          throw of_another_run();
        const std::size_t number = layout.number_of(head.unit);
        packed.resize(sizeof head + head.bytes);
        if (!read_at(file_, at, packed.data(), packed.size()) ||
            !belongs_to(head, std::string_view(packed).substr(sizeof head))) {
          damaged_[number] = true;
          return;
        }
        try {
          contents_of_packed(packed, layout);
        } catch (const DamagedPing&) {
          throw of_another_run();
        }
        places_[number] = at;
      },
      unreadable_);
}

bool PingFile::may_have_damaged(const PingUnit& unit) const {
  return !has(unit) && (unreadable_ || damaged_.at(layout_.number_of(unit)));
}

void PingFile::begin(const std::string& identity, std::uint64_t reserved_bytes) {
  const bool anew = identity_.empty();
  if (!file_) file_ = taken(path_, kind_, true);
  try {
    end_ = anew ? 0 : end_;
    // removes a ping that was only partly written
    if (ftruncate(file_.number(), static_cast<off_t>(end_)) != 0) fail("write the " + kind_, errno);
    if (reserved_bytes > 0) reserve(reserved_bytes);
    if (anew) begin_anew(identity);
  } catch (...) {
    if (anew) fs::remove(path_);
    throw;
  }
}

void PingFile::begin_anew(const std::string& identity) {
  PingFileHeader header;
  header.identity_bytes = identity.size();
  header.identity_checksum = checksum_of(identity);
  header.head_checksum = checksum_of(header);
  write(std::string(reinterpret_cast<const char*>(&header), sizeof header) + identity);
  identity_ = identity;
  first_record_ = end_;
  sync();
  sync_names_in(absolute_path(path_).parent_path());
}

void PingFile::reserve(std::uint64_t bytes) const {
  // Some file systems do not fail at once, but fill the disk first.
  std::error_code unknown;
  const fs::space_info disk = fs::space(path_, unknown);
  const int error = !unknown && disk.available < bytes ? ENOSPC : reserve_beyond(file_.number(), bytes);
  if (error != 0) fail(fmt::format("reserve {:.1f} MB for the pings", double(bytes) / 1e6), error);
}

void PingFile::write(std::string_view bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t put =
        pwrite(file_.number(), bytes.data() + done, bytes.size() - done, static_cast<off_t>(end_ + done));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) {
      const int cause = put < 0 ? errno : ENOSPC;
      // The result does not matter, because a partly written ping is also detected when the file is read.
      [[maybe_unused]] const int ignored = ftruncate(file_.number(), static_cast<off_t>(end_));
      fail("write the " + kind_, cause);
    }
    done += static_cast<std::size_t>(put);
  }
  end_ += bytes.size();
}

void PingFile::append(std::string_view packed) {
  constexpr std::chrono::seconds between_syncs{5};
  PingUnit unit;
  std::memcpy(&unit, packed.data(), sizeof unit);
  bool due = false;
  {
    const std::lock_guard lock(mutex_);
    const std::uint64_t at = end_;
    write(packed);
    if (!places_.empty()) places_.at(layout_.number_of(unit)).store(at, std::memory_order_release);
    const auto now = std::chrono::steady_clock::now();
    due = now >= next_sync_;
    if (due) next_sync_ = now + between_syncs;
  }
  if (due) sync();
}

std::string PingFile::read(const PingUnit& unit, std::size_t first, std::size_t count) const {
  const std::uint64_t at = place(unit).load(std::memory_order_acquire);
  std::string bytes(count, '\0');
  if (at == missing || !read_at(file_, at + first, bytes.data(), count))
    throw DamagedPing("it cannot be read");
  return bytes;
}

std::string PingFile::read(const PingUnit& unit) const {
  const PackedHead head = head_of_packed(read(unit, 0, sizeof(PackedHead)), layout_);
  if (std::memcmp(&head.unit, &unit, sizeof unit) != 0) throw DamagedPing("it is another ping");
  return read(unit, 0, sizeof head + head.bytes);
}

void PingFile::sync() const {
  if (!file_) return;
  int status = 0;
  do {
    status = fdatasync(file_.number());
  } while (status != 0 && errno == EINTR);
  if (status != 0) fail("write the pings to the disk", errno);
}

StoreSummary summary_of(const fs::path& path) {
  Descriptor opened = open_own(path, O_RDONLY);
  if (!opened) throw UnusableStore(fmt::format("'{}': {}", path.string(), std::strerror(errno)));
  const bool in_use = is_locked_by_another(opened);
  const PingFile file(path, "checkpoint", std::move(opened));
  return {file.identity(), file.pings(), in_use};
}

}  // namespace tubefoot
