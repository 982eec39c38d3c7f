// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/ping_store.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <numeric>

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// The start of a file. What follows: the identity's text, the units, each sensor's energies and bounds,
/// every part at a multiple of `alignment`.
struct Header {
  char magic[16] = {'t', 'u', 'b', 'e', 'f', 'o', 'o', 't', ' ', 'p', 'i', 'n', 'g', 's', ' ', '3'};
  std::uint64_t identity_bytes = 0, identity_checksum = 0, units = 0, bytes = 0;
};

std::uint64_t checksum_of(const std::string& text) {
  return crc32_z(crc32(0, nullptr, 0), reinterpret_cast<const unsigned char*>(text.data()), text.size());
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
StoreSummary read_summary(int file, const fs::path& path, Header& header) {
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

}  // namespace

std::size_t StoreLayout::units() const {
  std::size_t all = 0;
  for (const Group& group : groups) all += group.pings;
  return all;
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

PingStore::PingStore(const StoreLayout& layout) : PingStore(layout, fs::path(), 0) { map(-1); }

PingStore::PingStore(const StoreLayout& layout, const fs::path& file, const std::string& identity)
    : PingStore(layout, file, identity.size()) {
  file_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) fail(file, "create the file of pings", errno);
  if (flock(file_, LOCK_EX | LOCK_NB) != 0)
    throw std::runtime_error(
        fmt::format("another run is writing '{}': choose another -o, or wait", file.string()));
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
  if (ftruncate(file_, 0) != 0) abandon(errno);
  if (const ssize_t put = pwrite(file_, head.data(), head.size(), 0);
      put != static_cast<ssize_t>(head.size()))
    abandon(put < 0 ? errno : ENOSPC);
  if (ftruncate(file_, static_cast<off_t>(bytes_)) != 0) abandon(errno);
  if (const int error = posix_fallocate(file_, 0, static_cast<off_t>(bytes_)); error != 0) abandon(error);
  try {
    map(file_);
  } catch (...) {
    fs::remove(file);
    throw;
  }
}

std::unique_ptr<PingStore> PingStore::reopen(const StoreLayout& layout, const fs::path& path) {
  const int file = open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) throw UnusableStore(fmt::format("'{}': {}", path.string(), std::strerror(errno)));
  std::unique_ptr<PingStore> store;
  try {
    Header header;
    const StoreSummary summary = read_summary(file, path, header);
    store.reset(new PingStore(layout, path, summary.identity.size()));
    if (header.units != layout.units() || header.bytes != store->bytes_)
      throw UnusableStore(fmt::format("'{}' holds other pings than this run makes", path.string()));
    if (flock(file, LOCK_EX | LOCK_NB) != 0)
      throw UnusableStore(fmt::format("'{}' is in use by another run", path.string()));
  } catch (...) {
    close(file);
    throw;
  }
  store->file_ = file;
  store->map(file);
  for (std::size_t group = 0; group < layout.groups.size(); ++group)
    for (std::size_t ping = 0; ping < layout.groups[group].pings; ++ping) {
      Unit& unit = store->unit(group, ping);
      if (unit.checksum == 0 || unit.checksum == store->checksum(group, ping)) continue;
      unit = {};
      for (const std::size_t sensor : layout.groups[group].sensors)
        for (const int which : {0, 1}) {
          const std::span<double> part = store->part(sensor, ping, which);
          std::fill(part.begin(), part.end(), 0.0);
        }
    }
  return store;
}

PingStore::~PingStore() {
  if (data_ != nullptr) munmap(data_, bytes_);
  if (file_ >= 0) close(file_);
}

void PingStore::map(int file) {
  const int flags = file < 0 ? MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE : MAP_SHARED;
  void* data = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, flags, file, 0);
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

std::span<double> PingStore::block(std::size_t sensor, int which) {
  const StoreLayout::Sensor& s = layout_.sensors.at(sensor);
  if (which == 1 && !layout_.with_bounds) return {};
  const std::size_t bytes = aligned(s.pings * s.cells * sizeof(double));
  return {reinterpret_cast<double*>(data_ + first_byte_[sensor] + which * bytes), s.pings * s.cells};
}

std::span<double> PingStore::part(std::size_t sensor, std::size_t ping, int which) {
  const std::span<double> all = block(sensor, which);
  const std::size_t cells = layout_.sensors[sensor].cells;
  return all.empty() ? all : all.subspan(ping * cells, cells);
}

/// Of the energies, bounds and counts; never 0.
std::uint64_t PingStore::checksum(std::size_t group, std::size_t ping) {
  std::uint64_t sum = crc32(0, nullptr, 0);
  const auto add = [&](const void* data, std::size_t bytes) {
    sum = crc32_z(sum, static_cast<const unsigned char*>(data), bytes);
  };
  add(&unit(group, ping).counts, sizeof(PingCounts));
  for (const std::size_t sensor : layout_.groups[group].sensors)
    for (const int which : {0, 1}) {
      const std::span<double> values = part(sensor, ping, which);
      if (!values.empty()) add(values.data(), values.size_bytes());
    }
  return sum | std::uint64_t{1} << 32;
}

void PingStore::finish(std::size_t group, std::size_t ping, const PingCounts& counts) {
  Unit& finished = unit(group, ping);
  finished.counts = counts;
  // A killed program's pages reach the file in any order: only the sum makes a ping count.
  std::atomic_ref(finished.checksum).store(checksum(group, ping), std::memory_order_release);
  for (const std::size_t sensor : layout_.groups[group].sensors) release(sensor, ping);
}

void PingStore::release(std::size_t sensor, std::size_t ping) {
  if (file_ < 0) return;
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
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw UnusableStore(fmt::format("'{}': {}", path.string(), std::strerror(errno)));
  struct Closer {
    int file;
    ~Closer() { close(file); }
  } const closer{file};
  Header header;
  StoreSummary summary = read_summary(file, path, header);
  summary.in_use = flock(file, LOCK_EX | LOCK_NB) != 0;
  const std::size_t first = aligned(sizeof header + summary.identity.size());
  for (std::size_t unit = 0; unit < summary.units; ++unit) {
    std::uint64_t checksum = 0;
    if (pread(file, &checksum, sizeof checksum,
              static_cast<off_t>(first + unit * (sizeof checksum + sizeof(PingCounts)))) != sizeof checksum)
      break;
    summary.done += checksum != 0;
  }
  return summary;
}

}  // namespace tubefoot
