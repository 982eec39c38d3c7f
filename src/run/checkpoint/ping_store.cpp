// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/checkpoint/ping_store.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <libdeflate.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <deque>
#include <mutex>
#include <system_error>
#include <tuple>
#include <utility>

#include "files/absolute_path.hpp"
#include "files/durable.hpp"
#include "files/hdf5_chunks.hpp"
#include "files/staging.hpp"

// This file implements the store of a run's pings. A file consists of a header, the identity of the run as
// text, a table of units, and packed pings in the order of completion. A unit contains the checksum,
// position, length and counts of a ping. Header and table are mapped into memory.

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Start of a file. The text of the identity, the units, and the packed pings follow. The units and the
/// first packed ping start at multiples of `alignment`.
struct Header {
  char magic[16] = {'t', 'u', 'b', 'e', 'f', 'o', 'o', 't', ' ', 'p', 'i', 'n', 'g', 's', ' ', '4'};
  std::uint64_t identity_bytes = 0, identity_checksum = 0, units = 0, bytes = 0;
};

std::uint64_t checksum_of(const std::string& text) { return libdeflate_crc32(0, text.data(), text.size()); }

std::uint64_t checksum_of(std::uint64_t first, std::uint64_t bytes, const PingCounts& counts) {
  std::uint32_t sum = libdeflate_crc32(0, &counts, sizeof counts);
  sum = libdeflate_crc32(sum, &first, sizeof first);
  sum = libdeflate_crc32(sum, &bytes, sizeof bytes);
  return std::uint64_t{sum} | std::uint64_t{1} << 32;  // never 0
}

/// Copies only pages with non-zero values, so that pages of zeros take no memory.
void put_in_memory(std::span<const double> values, std::span<double> place) {
  constexpr std::size_t page = 4096 / sizeof(double);
  for (std::size_t first = 0; first < values.size(); first += page) {
    const std::span<const double> some = values.subspan(first, std::min(page, values.size() - first));
    if (std::ranges::any_of(some, [](double value) { return std::bit_cast<std::uint64_t>(value) != 0; }))
      std::ranges::copy(some, place.begin() + std::ptrdiff_t(first));
  }
}

// Size of a ping's entry in the file: checksum, position, length and counts.
constexpr std::size_t unit_bytes = 3 * sizeof(std::uint64_t) + sizeof(PingCounts);
constexpr std::size_t alignment = 4096;
constexpr std::size_t aligned(std::size_t bytes) { return (bytes + alignment - 1) / alignment * alignment; }

[[noreturn]] void fail(const fs::path& file, const char* task, int error) {
  throw std::runtime_error(fmt::format("{}: cannot {}: {}", file.string(), task, std::strerror(error)));
}

/// Reads the header and the identity, and checks everything that does not depend on the scene.
StoreSummary read_summary(const Descriptor& opened, const fs::path& path, Header& header) {
  const int file = opened.number();
  struct stat status {};
  const auto unusable = [&](const char* why) {
    return UnusableStore(fmt::format("'{}' {}", path.string(), why));
  };
  if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) throw unusable("is not a checkpoint");
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (size == 0) return {};  // the run was killed before it wrote the header
  if (pread(file, &header, sizeof header, 0) != sizeof header ||
      std::memcmp(header.magic, Header{}.magic, sizeof header.magic) != 0)
    throw unusable("is not a checkpoint of this version of tubefoot");
  // the run was killed before it reserved its disk space
  const bool begun = header.identity_bytes == size - sizeof header;
  if ((header.bytes != size && !begun) || header.identity_bytes > size - sizeof header)
    throw unusable("is cut short");
  StoreSummary summary;
  summary.identity.resize(header.identity_bytes);
  if (pread(file, summary.identity.data(), header.identity_bytes, sizeof header) !=
      static_cast<ssize_t>(header.identity_bytes))
    throw unusable("cannot be read");
  if (checksum_of(summary.identity) != header.identity_checksum) throw unusable("is damaged");
  summary.units = header.units;
  return summary;
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
void require_own(const Descriptor& file, const fs::path& path) {
  struct stat status {};
  const char* foreign = fstat(file.number(), &status) != 0 || !S_ISREG(status.st_mode) ? "is not a checkpoint"
                        : status.st_nlink > 1 ? "has a second hard link"
                        : status.st_uid != geteuid() && status.st_uid != owner_of_new_files(path)
                            ? "belongs to another user"
                            : nullptr;
  if (foreign != nullptr) throw UnusableStore(fmt::format("'{}' {}", path.string(), foreign));
}

}  // namespace

StoreInUse::StoreInUse(const fs::path& file)
    : UnusableStore(fmt::format("another run is writing '{}': choose another -o, or wait", file.string())) {}

Descriptor take_ping_file(const fs::path& path, bool make) {
  constexpr int most_trials = 10;  // another run may be about to remove the file
  for (int trial = 0; trial < most_trials; ++trial) {
    Descriptor file = open_own(path, O_RDWR | (make ? O_CREAT | O_EXCL : 0));
    if (!file) {
      if (make && errno == EEXIST) throw StoreInUse(path);
      if (make) fail(path, "create the checkpoint", errno);
      if (errno == ENOENT) return file;
      throw UnusableStore(fmt::format("cannot open the checkpoint '{}' ({})", path.string(),
                                      errno == ELOOP ? "it is a symbolic link" : std::strerror(errno)));
    }
    require_own(file, path);
    try {
      if (!take_lock(file)) throw StoreInUse(path);
    } catch (const std::system_error& error) {
      if (make) fs::remove(path);
      fail(path, "lock the checkpoint", error.code().value());
    }
    if (is_still_at(path, file)) return file;
  }
  throw StoreInUse(path);
}

/// Cache of recently unpacked values, because several products read a ping at about the same time. It reuses
/// its memory, because new memory costs as much time as unpacking.
class PingStore::Unpacked {
 public:
  using Key = std::tuple<std::size_t, std::size_t, std::size_t, bool>;
  using Values = std::shared_ptr<std::vector<double>>;

  /// Returns null if the values have to be unpacked.
  Values find(const Key& key) {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(recent_, key, &std::pair<Key, Values>::first);
    return found == recent_.end() ? nullptr : found->second;
  }
  /// Returns memory for `count` values.
  Values room(std::size_t count) {
    std::vector<double> values = spare_->take();
    values.resize(count);
    return {new std::vector<double>(std::move(values)), [spare = spare_](std::vector<double>* used) {
              const std::unique_ptr<std::vector<double>> owned(used);
              spare->give_back(*owned);
            }};
  }
  void keep(const Key& key, const Values& values) {
    std::vector<Values> old;  // freed after the lock is released
    const std::lock_guard lock(mutex_);
    recent_.emplace_back(key, values);
    bytes_ += values->size() * sizeof(double);
    while (bytes_ > most_bytes) {
      bytes_ -= recent_.front().second->size() * sizeof(double);
      old.push_back(std::move(recent_.front().second));
      recent_.pop_front();
    }
  }

 private:
  static constexpr std::size_t most_bytes = std::size_t{16} << 20;

  class Spare {
   public:
    std::vector<double> take() {
      const std::lock_guard lock(mutex_);
      if (values_.empty()) return {};
      std::vector<double> taken = std::move(values_.back());
      values_.pop_back();
      bytes_ -= taken.capacity() * sizeof(double);
      return taken;
    }
    void give_back(std::vector<double>& values) noexcept {
      const std::lock_guard lock(mutex_);
      const std::size_t bytes = values.capacity() * sizeof(double);
      if (values_.size() == values_.capacity() || bytes_ + bytes > most_bytes) return;
      values_.push_back(std::move(values));
      bytes_ += bytes;
    }
    Spare() { values_.reserve(most); }

   private:
    static constexpr std::size_t most = 16;
    std::mutex mutex_;
    std::vector<std::vector<double>> values_;
    std::size_t bytes_ = 0;
  };

  std::mutex mutex_;
  std::deque<std::pair<Key, Values>> recent_;  ///< the oldest first
  std::size_t bytes_ = 0;
  std::shared_ptr<Spare> spare_ = std::make_shared<Spare>();
};

PingStore::PingStore(const StoreLayout& layout, fs::path path, std::size_t identity_bytes)
    : layout_(layout),
      path_(std::move(path)),
      first_unit_byte_(aligned(sizeof(Header) + identity_bytes)),
      group_of_(layout_.sensors.size(), 0),
      unpacked_(std::make_unique<Unpacked>()) {
  std::size_t unit = 0;
  for (std::size_t group = 0; group < layout_.groups.size(); ++group) {
    first_unit_.push_back(unit);
    unit += layout_.groups[group].pings;
    for (const std::size_t sensor : layout_.groups[group].sensors) group_of_.at(sensor) = group;
  }
  bytes_ = aligned(first_unit_byte_ + unit * sizeof(Unit));
  // A scene with many large sensors may request more bytes than an integer can count.
  double requested = 0;
  for (const StoreLayout::Sensor& sensor : layout_.sensors)
    requested += static_cast<double>(sensor.pings) * static_cast<double>(sensor.cells) * sizeof(double);
  if (constexpr double most = 0x1p60; requested > most)
    throw std::runtime_error(fmt::format(
        "{}: the energies of the pings would need {:.3g} GB: reduce the number of pings per scene",
        path_.string(), requested / 1e9));
  mapped_bytes_ = bytes_;
  end_ = bytes_;
  if (!path_.empty()) {
    for (std::size_t group = 0; group < layout_.groups.size(); ++group)
      bytes_ += layout_.groups[group].pings * most_packed(layout_, group);
    bytes_ = aligned(bytes_);
    return;
  }
  for (const StoreLayout::Sensor& sensor : layout_.sensors) {
    first_byte_.push_back(bytes_);
    for (int blocks = layout_.with_bounds ? 2 : 1; blocks > 0; --blocks)
      bytes_ = aligned(bytes_ + sensor.pings * sensor.cells * sizeof(double));
  }
  mapped_bytes_ = bytes_;
}

PingStore::PingStore(const StoreLayout& layout) : PingStore(layout, fs::path(), 0) { map(); }

PingStore::PingStore(const StoreLayout& layout, const fs::path& file, const std::string& identity)
    : PingStore(
          layout, file,
          [&file] {
            Descriptor there = take_ping_file(file, false);
            return there ? std::move(there) : take_ping_file(file, true);
          }(),
          identity) {}

PingStore::PingStore(const StoreLayout& layout, const fs::path& file, Descriptor taken,
                     const std::string& identity)
    : PingStore(layout, file, identity.size()) {
  file_ = std::move(taken);
  const auto abandon = [&](int error) {  // the destructor closes the file
    fs::remove(file);
    fail(file, fmt::format("reserve {:.1f} MB for the pings", double(bytes_) / 1e6).c_str(), error);
  };
  Header header;
  header.identity_bytes = identity.size();
  header.identity_checksum = checksum_of(identity);
  header.units = layout_.units();
  header.bytes = bytes_;
  // Some file systems do not fail at once, but fill the disk first.
  std::error_code unknown;
  if (const fs::space_info disk = fs::space(file, unknown); !unknown && disk.available < bytes_)
    abandon(ENOSPC);
  // If the program is killed between any two of these calls, read_summary() treats the file as one without
  // pings.
  std::string head(reinterpret_cast<const char*>(&header), sizeof header);
  head += identity;
  if (ftruncate(file_.number(), 0) != 0) abandon(errno);
  if (const ssize_t put = pwrite(file_.number(), head.data(), head.size(), 0);
      put != static_cast<ssize_t>(head.size()))
    abandon(put < 0 ? errno : ENOSPC);
  if (ftruncate(file_.number(), static_cast<off_t>(bytes_)) != 0) abandon(errno);
  if (const int error = posix_fallocate(file_.number(), 0, static_cast<off_t>(bytes_)); error != 0)
    abandon(error);
  try {
    map();
    sync();
    sync_names_in(absolute_path(file).parent_path());
  } catch (...) {
    fs::remove(file);
    throw;
  }
}

std::unique_ptr<PingStore> PingStore::reopen(const StoreLayout& layout, const fs::path& path) {
  Descriptor there = take_ping_file(path, false);
  if (!there) throw UnusableStore(fmt::format("'{}': no such file", path.string()));
  return reopen(layout, path, std::move(there));
}

std::unique_ptr<PingStore> PingStore::reopen(const StoreLayout& layout, const fs::path& path,
                                             Descriptor taken) {
  Header header;
  const StoreSummary summary = read_summary(taken, path, header);
  std::unique_ptr<PingStore> store(new PingStore(layout, path, summary.identity.size()));
  if (header.units != layout.units() || header.bytes != store->bytes_)
    throw UnusableStore(fmt::format("'{}' contains pings of another run", path.string()));
  store->file_ = std::move(taken);
  store->map();
  store->look_through();
  return store;
}

/// Checks that the pings marked as done are intact.
void PingStore::look_through() {
  std::string packed;
  for (std::size_t group = 0; group < layout_.groups.size(); ++group)
    for (std::size_t ping = 0; ping < layout_.groups[group].pings; ++ping) {
      Unit& unit = this->unit(group, ping);
      if (unit.checksum == 0) continue;
      bool whole = unit.checksum == checksum_of(unit.first, unit.bytes, unit.counts) &&
                   unit.first >= mapped_bytes_ && unit.bytes <= most_packed(layout_, group) &&
                   unit.first <= bytes_ - unit.bytes;
      try {
        if (whole) {
          packed.resize(unit.bytes);
          read(unit.first, packed.data(), packed.size());
          const PingUnit there = checked_contents(packed, layout_).unit;
          whole = there.group == group && there.ping == ping;
        }
      } catch (const DamagedPing&) {
        whole = false;
      }
      if (whole)
        end_ = std::max<std::uint64_t>(end_, unit.first + unit.bytes);
      else
        unit = {};
    }
}

PingStore::~PingStore() {
  if (data_ != nullptr) munmap(data_, mapped_bytes_);
}

void PingStore::map() {
  const int flags = file_ ? MAP_SHARED : MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE;
  void* data = mmap(nullptr, mapped_bytes_, PROT_READ | PROT_WRITE, flags, file_.number(), 0);
  if (data == MAP_FAILED) fail(path_.empty() ? "memory" : path_, "map the pings", errno);
  data_ = static_cast<unsigned char*>(data);
}

PingStore::Unit& PingStore::unit(std::size_t group, std::size_t ping) const {
  static_assert(sizeof(Unit) == unit_bytes);
  return reinterpret_cast<Unit*>(data_ + first_unit_byte_)[first_unit_.at(group) + ping];
}

std::size_t PingStore::done_units() const {
  std::size_t all = 0;
  for (std::size_t group = 0; group < layout_.groups.size(); ++group)
    for (std::size_t ping = 0; ping < layout_.groups[group].pings; ++ping) all += done(group, ping);
  return all;
}

std::span<double> PingStore::block(std::size_t sensor, int which) const {
  const StoreLayout::Sensor& s = layout_.sensors.at(sensor);
  if (file_) throw std::logic_error("packed pings are not in memory");
  if (which == 1 && !layout_.with_bounds) return {};
  const std::size_t bytes = aligned(s.pings * s.cells * sizeof(double));
  return {reinterpret_cast<double*>(data_ + first_byte_[sensor] + which * bytes), s.pings * s.cells};
}

std::span<double> PingStore::part(std::size_t sensor, std::size_t ping, int which) const {
  const std::span<double> all = block(sensor, which);
  const std::size_t cells = layout_.sensors[sensor].cells;
  return all.empty() ? all : all.subspan(ping * cells, cells);
}

void PingStore::read(std::uint64_t first, void* bytes, std::size_t count) const {
  for (auto* to = static_cast<char*>(bytes); count > 0;) {
    const ssize_t got = pread(file_.number(), to, count, static_cast<off_t>(first));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) fail(path_, "read a stored ping", got < 0 ? errno : EIO);
    to += got, first += std::uint64_t(got), count -= std::size_t(got);
  }
}

void PingStore::write(std::uint64_t first, std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t put = pwrite(file_.number(), bytes.data(), bytes.size(), static_cast<off_t>(first));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) fail(path_, "keep a ping", put < 0 ? errno : ENOSPC);
    first += std::uint64_t(put), bytes.remove_prefix(std::size_t(put));
  }
}

void PingStore::finish(std::size_t group, std::size_t ping, const PingCounts& counts,
                       const PingValues& values) {
  if (file_) {
    keep(packed_ping(layout_, {group, ping}, counts, values));
    return;
  }
  for (const std::size_t sensor : layout_.groups[group].sensors)
    for (const int which : {0, 1})
      put_in_memory(which == 0 ? values.energy(sensor) : values.bound(sensor), part(sensor, ping, which));
  mark_done({group, ping}, 0, 0, counts);
}

void PingStore::keep(std::string_view packed) {
  if (!file_) {
    PingValues values;
    const PingCounts counts = unpack_ping(packed, layout_, values);
    const PingUnit unit = head_of_packed(packed, layout_).unit;
    finish(unit.group, unit.ping, counts, values);
    return;
  }
  const PackedContents contents = checked_contents(packed, layout_);
  const std::uint64_t first = end_.fetch_add(packed.size());
  // The file has space for all pings at their largest size. Only damaged pings that are computed again need
  // more.
  if (first + packed.size() > bytes_) fail(path_, "keep a ping", ENOSPC);
  write(first, packed);
  mark_done(contents.unit, first, packed.size(), contents.counts);
  // One thread at a time flushes, and no ping waits for it. It does not matter which pages are already on
  // the disk.
  constexpr std::chrono::seconds between_syncs{5};
  const auto now = std::chrono::steady_clock::now();
  if (auto due = next_sync_.load();
      now >= due && next_sync_.compare_exchange_strong(due, now + between_syncs))
    sync();
}

void PingStore::mark_done(const PingUnit& at, std::uint64_t first, std::uint64_t bytes,
                          const PingCounts& counts) {
  Unit& finished = unit(at.group, at.ping);
  finished.first = first;
  finished.bytes = bytes;
  finished.counts = counts;
  // The pages of a killed program reach the file in any order. A ping therefore counts only if its checksums
  // match.
  std::atomic_ref(finished.checksum).store(checksum_of(first, bytes, counts), std::memory_order_release);
}

std::shared_ptr<const double> PingStore::values(std::size_t ping, const ChunkName& name) const {
  const std::size_t count = values_a_chunk(name.sensor);
  if (!file_) {
    const std::shared_ptr<const void> in_memory_anyway;
    return {in_memory_anyway, part(name.sensor, ping, name.bound ? 1 : 0).data() + name.channel * count};
  }
  const Unpacked::Key key{name.sensor, ping, name.channel, name.bound};
  Unpacked::Values made = unpacked_->find(key);
  if (!made) {
    made = unpacked_->room(count);
    if (!unpack_chunk(chunk(ping, name), *made))
      throw std::runtime_error(
          fmt::format("{}: ping {} can no longer be decompressed", path_.string(), ping));
    unpacked_->keep(key, made);
  }
  return {made, made->data()};
}

std::vector<unsigned char> PingStore::chunk(std::size_t ping, const ChunkName& name) const {
  const std::size_t group = group_of_.at(name.sensor);
  const Unit& kept = unit(group, ping);
  const auto gone = [&] {
    return std::runtime_error(
        fmt::format("{}: ping {} has changed since it was stored", path_.string(), ping));
  };
  std::string beginning(before_chunks(layout_, group), '\0');
  if (kept.checksum == 0 || kept.bytes < beginning.size()) throw gone();
  read(kept.first, beginning.data(), beginning.size());
  try {
    const PackedContents contents = contents_of_packed(beginning, layout_);
    const PackedContents::Place place = contents.chunks.at(chunk_number(layout_, group, name));
    if (contents.unit.ping != ping || contents.unit.group != group || place.first + place.bytes > kept.bytes)
      throw gone();
    std::vector<unsigned char> bytes(place.bytes);
    read(kept.first + place.first, bytes.data(), bytes.size());
    return bytes;
  } catch (const DamagedPing&) {
    throw gone();
  }
}

void PingStore::sync() const {
  if (!file_) return;
  int status = 0;
  do {
    status = fdatasync(file_.number());  // for a mapped file, this also writes its pages
  } while (status != 0 && errno == EINTR);
  if (status != 0) fail(path_, "write the pings to the disk", errno);
}

StoreSummary summary_of(const fs::path& path) {
  const Descriptor file = open_own(path, O_RDONLY);
  if (!file) throw UnusableStore(fmt::format("'{}': {}", path.string(), std::strerror(errno)));
  return summary_of(path, file);
}

StoreSummary summary_of(const fs::path& path, const Descriptor& file) {
  Header header;
  StoreSummary summary = read_summary(file, path, header);
  summary.in_use = is_locked_by_another(file);
  const std::size_t first = aligned(sizeof header + summary.identity.size());
  for (std::size_t unit = 0; unit < summary.units; ++unit) {
    std::uint64_t checksum = 0;
    if (pread(file.number(), &checksum, sizeof checksum, static_cast<off_t>(first + unit * unit_bytes)) !=
        sizeof checksum)
      break;
    summary.done += checksum != 0;
  }
  return summary;
}

}  // namespace tubefoot
