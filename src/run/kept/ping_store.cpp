// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/kept/ping_store.hpp"

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
#include <numeric>
#include <system_error>

#include "files/durable.hpp"
#include "files/staging.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// The start of a file. What follows: the identity's text, the units, each sensor's energies and bounds,
/// every part at a multiple of `alignment`.
struct Header {
  char magic[16] = {'t', 'u', 'b', 'e', 'f', 'o', 'o', 't', ' ', 'p', 'i', 'n', 'g', 's', ' ', '3'};
  std::uint64_t identity_bytes = 0, identity_checksum = 0, units = 0, bytes = 0;
};

std::uint64_t checksum_of(const std::string& text) { return libdeflate_crc32(0, text.data(), text.size()); }

/// Of a ping's counts, energies and bounds, as `values_of(sensor, which)` has them; never 0.
template <class ValuesOf>
std::uint64_t checksum_of(const StoreLayout::Group& group, const PingCounts& counts,
                          const ValuesOf& values_of) {
  std::uint32_t sum = libdeflate_crc32(0, &counts, sizeof counts);
  for (const std::size_t sensor : group.sensors)
    for (const int which : {0, 1})
      if (const std::span<const double> values = values_of(sensor, which); !values.empty())
        sum = libdeflate_crc32(sum, values.data(), values.size_bytes());
  return std::uint64_t{sum} | std::uint64_t{1} << 32;
}

constexpr std::size_t alignment = 4096;
// Linux maps a page that is read together with those about it, in windows of addresses of this size
// (fault_around_bytes).
constexpr std::size_t window = 65536;
constexpr std::size_t aligned(std::size_t bytes) { return (bytes + alignment - 1) / alignment * alignment; }

[[noreturn]] void fail(const fs::path& file, const char* task, int error) {
  throw std::runtime_error(fmt::format("{}: cannot {}: {}", file.string(), task, std::strerror(error)));
}

/// Reads the header and the identity; checks what can be checked without the scene.
StoreSummary read_summary(const Descriptor& opened, const fs::path& path, Header& header) {
  const int file = opened.number();
  struct stat status {};
  const auto unusable = [&](const char* why) {
    return UnusableStore(fmt::format("'{}' {}", path.string(), why));
  };
  if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) throw unusable("is not a file of pings");
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (size == 0) return {};  // of a run that was killed as it began
  if (pread(file, &header, sizeof header, 0) != sizeof header ||
      std::memcmp(header.magic, Header{}.magic, sizeof header.magic) != 0)
    throw unusable("is not a file of pings of this version");
  const bool begun = header.identity_bytes == size - sizeof header;  // killed before it took its space
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

/// Whose a file is that this process makes in a folder: not always its own, on disks of a server.
uid_t owner_of_new_files(const fs::path& beside) {
  const Staging probe(beside, 0700);
  struct stat status {};
  return lstat(probe.path().c_str(), &status) == 0 ? status.st_uid : geteuid();
}

/// Throws UnusableStore unless it may be written: what is planted under the name of a run's pings would lead
/// it to write over another file, or give it pings that others can change under it.
void require_own(const Descriptor& file, const fs::path& path) {
  struct stat status {};
  const char* foreign =
      fstat(file.number(), &status) != 0 || !S_ISREG(status.st_mode) ? "is not a file of pings"
      : status.st_nlink > 1                                          ? "has a second name elsewhere"
      : status.st_uid != geteuid() && status.st_uid != owner_of_new_files(path) ? "belongs to somebody else"
                                                                                : nullptr;
  if (foreign != nullptr) throw UnusableStore(fmt::format("'{}' {}", path.string(), foreign));
}

}  // namespace

StoreInUse::StoreInUse(const fs::path& file)
    : UnusableStore(fmt::format("another run is writing '{}': choose another -o, or wait", file.string())) {}

Descriptor take_ping_file(const fs::path& path, bool make) {
  constexpr int most_trials = 10;  // another run may just be giving the file up
  for (int trial = 0; trial < most_trials; ++trial) {
    Descriptor file = open_own(path, O_RDWR | (make ? O_CREAT | O_EXCL : 0));
    if (!file) {
      if (make && errno == EEXIST) throw StoreInUse(path);
      if (make) fail(path, "create the file of pings", errno);
      if (errno == ENOENT) return file;
      throw UnusableStore(fmt::format("'{}' cannot be opened as a file of pings ({})", path.string(),
                                      errno == ELOOP ? "it is a link" : std::strerror(errno)));
    }
    require_own(file, path);
    try {
      if (!take_lock(file)) throw StoreInUse(path);
    } catch (const std::system_error& error) {
      if (make) fs::remove(path);
      fail(path, "lock the file of pings", error.code().value());
    }
    if (is_still_at(path, file)) return file;
  }
  throw StoreInUse(path);
}

PingStore::PingStore(const StoreLayout& layout, fs::path path, std::size_t identity_bytes)
    : layout_(layout), path_(std::move(path)), first_unit_byte_(aligned(sizeof(Header) + identity_bytes)) {
  std::size_t unit = 0;
  for (const StoreLayout::Group& group : layout_.groups) {
    first_unit_.push_back(unit);
    unit += group.pings;
  }
  bytes_ = aligned(first_unit_byte_ + unit * sizeof(Unit));
  // A scene of many large sensors may ask for more than a number of bytes tells.
  double asked = 0;
  for (const StoreLayout::Sensor& sensor : layout_.sensors)
    asked += static_cast<double>(sensor.pings) * static_cast<double>(sensor.cells) * sizeof(double);
  if (constexpr double most = 0x1p60; asked > most)
    throw std::runtime_error(
        fmt::format("{}: the pings' energies would take {:.3g} GB: ask for fewer pings, in several scenes",
                    path_.string(), asked / 1e9));
  for (const StoreLayout::Sensor& sensor : layout_.sensors) {
    first_byte_.push_back(bytes_);
    for (int blocks = layout_.with_bounds ? 2 : 1; blocks > 0; --blocks)
      bytes_ = aligned(bytes_ + sensor.pings * sensor.cells * sizeof(double));
  }
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
  const auto abandon = [&](int error) {  // the destructor closes it
    fs::remove(file);
    fail(file, fmt::format("set {:.1f} MB aside for the pings", double(bytes_) / 1e6).c_str(), error);
  };
  Header header;
  header.identity_bytes = identity.size();
  header.identity_checksum = checksum_of(identity);
  header.units = layout_.units();
  header.bytes = bytes_;
  // Not every file system refuses at once: some fill the disk first.
  std::error_code unknown;
  if (const fs::space_info disk = fs::space(file, unknown); !unknown && disk.available < bytes_)
    abandon(ENOSPC);
  // Killed between any two of these calls, it leaves a file that read_summary() takes for one without pings.
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
    sync_names_in(fs::absolute(file).parent_path());
  } catch (...) {
    fs::remove(file);
    throw;
  }
}

std::unique_ptr<PingStore> PingStore::reopen(const StoreLayout& layout, const fs::path& path) {
  Descriptor there = take_ping_file(path, false);
  if (!there) throw UnusableStore(fmt::format("'{}': there is no such file", path.string()));
  return reopen(layout, path, std::move(there));
}

std::unique_ptr<PingStore> PingStore::reopen(const StoreLayout& layout, const fs::path& path,
                                             Descriptor taken) {
  Header header;
  const StoreSummary summary = read_summary(taken, path, header);
  std::unique_ptr<PingStore> store(new PingStore(layout, path, summary.identity.size()));
  if (header.units != layout.units() || header.bytes != store->bytes_)
    throw UnusableStore(fmt::format("'{}' holds other pings than this run makes", path.string()));
  store->file_ = std::move(taken);
  store->map();
  for (std::size_t group = 0; group < layout.groups.size(); ++group)
    for (std::size_t ping = 0; ping < layout.groups[group].pings; ++ping) {
      Unit& unit = store->unit(group, ping);
      if (unit.checksum == 0) continue;
      const std::uint64_t found =
          checksum_of(layout.groups[group], unit.counts,
                      [&](std::size_t sensor, int which) { return store->part(sensor, ping, which); });
      if (unit.checksum != found) unit = {};
    }
  return store;
}

PingStore::~PingStore() {
  if (data_ != nullptr) munmap(data_, bytes_);
}

void PingStore::map() {
  const int flags = file_ ? MAP_SHARED : MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE;
  void* data = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, flags, file_.number(), 0);
  if (data == MAP_FAILED) fail(path_.empty() ? "memory" : path_, "map the pings", errno);
  data_ = static_cast<unsigned char*>(data);
}

PingStore::Unit& PingStore::unit(std::size_t group, std::size_t ping) const {
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
  if (which == 1 && !layout_.with_bounds) return {};
  const std::size_t bytes = aligned(s.pings * s.cells * sizeof(double));
  return {reinterpret_cast<double*>(data_ + first_byte_[sensor] + which * bytes), s.pings * s.cells};
}

std::span<double> PingStore::part(std::size_t sensor, std::size_t ping, int which) const {
  const std::span<double> all = block(sensor, which);
  const std::size_t cells = layout_.sensors[sensor].cells;
  return all.empty() ? all : all.subspan(ping * cells, cells);
}

/// A file's by the system's call: through the mapping they would take a fault a page. All of them: a disk is
/// slow to free what lies in many pieces. In memory, what is silent takes no pages.
void PingStore::put(std::span<const double> values, std::span<double> place) const {
  if (values.empty()) return;
  if (!file_) {
    constexpr std::size_t page = alignment / sizeof(double);
    for (std::size_t first = 0; first < values.size(); first += page) {
      const std::span<const double> some = values.subspan(first, std::min(page, values.size() - first));
      if (std::ranges::any_of(some, [](double value) { return std::bit_cast<std::uint64_t>(value) != 0; }))
        std::ranges::copy(some, place.begin() + std::ptrdiff_t(first));
    }
    return;
  }
  const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
  auto at = static_cast<std::size_t>(reinterpret_cast<unsigned char*>(place.data()) - data_);
  for (std::size_t left = values.size_bytes(); left > 0;) {
    const ssize_t written = pwrite(file_.number(), bytes, left, static_cast<off_t>(at));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(path_, "keep a ping", written < 0 ? errno : ENOSPC);
    bytes += written, at += std::size_t(written), left -= std::size_t(written);
  }
}

void PingStore::finish(std::size_t group, std::size_t ping, const PingCounts& counts,
                       const PingValues& values) {
  const StoreLayout::Group& kept = layout_.groups[group];
  const auto made = [&](std::size_t sensor, int which) {
    return which == 0 ? values.energy(sensor) : values.bound(sensor);
  };
  for (const std::size_t sensor : kept.sensors)
    for (const int which : {0, 1}) put(made(sensor, which), part(sensor, ping, which));
  Unit& finished = unit(group, ping);
  finished.counts = counts;
  // A killed program's pages reach the file in any order: only the sum makes a ping count.
  std::atomic_ref(finished.checksum).store(checksum_of(kept, counts, made), std::memory_order_release);
  // One thread at a time, and no ping waits for it: which of its pages are on the disk already does not
  // matter.
  constexpr std::chrono::seconds between_syncs{5};
  const auto now = std::chrono::steady_clock::now();
  if (auto due = next_sync_.load();
      now >= due && next_sync_.compare_exchange_strong(due, now + between_syncs))
    sync();
}

void PingStore::sync() const {
  if (!file_) return;
  int status = 0;
  do {
    status = fdatasync(file_.number());  // of a mapped file its pages, too
  } while (status != 0 && errno == EINTR);
  if (status != 0) fail(path_, "bring the pings to the disk", errno);
}

void PingStore::release(std::size_t sensor, std::size_t ping) {
  if (!file_) return;
  for (const int which : {0, 1}) {
    const std::span<double> values = part(sensor, ping, which);
    if (values.empty()) continue;
    // Pages that neighbours share go, too, or a long line would keep one a ping: the mapping is a file's, so
    // what a neighbour has written there is kept and comes back when it is touched. So do the pages before
    // them in their window: reading this ping brought them back.
    const auto address = [](const void* place) { return reinterpret_cast<std::uintptr_t>(place); };
    const std::uintptr_t begin = std::max(address(data_), address(values.data()) / window * window);
    const std::uintptr_t end = aligned(address(values.data() + values.size()));
    madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
  }
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
    if (pread(file.number(), &checksum, sizeof checksum,
              static_cast<off_t>(first + unit * (sizeof checksum + sizeof(PingCounts)))) != sizeof checksum)
      break;
    summary.done += checksum != 0;
  }
  return summary;
}

}  // namespace tubefoot
