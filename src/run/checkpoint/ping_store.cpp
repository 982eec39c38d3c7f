// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/checkpoint/ping_store.hpp"

#include <fmt/format.h>
#include <sys/mman.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <deque>
#include <mutex>
#include <tuple>
#include <utility>

#include "files/hdf5_chunks.hpp"

// This file implements the store of a run's pings, in memory or in a file of packed pings.

namespace tubefoot {
namespace {

/// Copies only pages with non-zero values, so that pages of zeros take no memory.
void put_in_memory(std::span<const double> values, std::span<double> place) {
  constexpr std::size_t page = 4096 / sizeof(double);
  for (std::size_t first = 0; first < values.size(); first += page) {
    const std::span<const double> some = values.subspan(first, std::min(page, values.size() - first));
    if (std::ranges::any_of(some, [](double value) { return std::bit_cast<std::uint64_t>(value) != 0; }))
      std::ranges::copy(some, place.begin() + std::ptrdiff_t(first));
  }
}

constexpr std::size_t page_bytes = 4096;
constexpr std::size_t aligned(std::size_t bytes) {
  return (bytes + page_bytes - 1) / page_bytes * page_bytes;
}

/// A scene with many large sensors may request more bytes than an integer can count.
void require_countable(const StoreLayout& layout, const std::string& where) {
  const double requested = layout.bytes();
  if (constexpr double most = 0x1p60; requested > most)
    throw std::runtime_error(fmt::format(
        "{}: the energies of the pings would need {:.3g} GB: reduce the number of pings per scene", where,
        requested / 1e9));
}

std::vector<std::size_t> groups_of_sensors(const StoreLayout& layout) {
  std::vector<std::size_t> groups(layout.sensors.size(), 0);
  for (std::size_t group = 0; group < layout.groups.size(); ++group)
    for (const std::size_t sensor : layout.groups[group].sensors) groups.at(sensor) = group;
  return groups;
}

/// Returns the largest possible size of the pings that the file lacks.
std::uint64_t missing_bytes(const StoreLayout& layout, const PingFile& file) {
  std::uint64_t bytes = 0;
  for (std::size_t group = 0; group < layout.groups.size(); ++group) {
    const std::uint64_t most = most_packed(layout, group);
    for (std::size_t ping = 0; ping < layout.groups[group].pings; ++ping)
      if (!file.has({group, ping})) bytes += most;
  }
  return bytes;
}

}  // namespace

/// Cache of recently unpacked values, because several products read a ping at about the same time. It reuses
/// its memory, because new memory costs as much time as unpacking.
class PingStore::Unpacked {
 public:
  using Key = std::tuple<std::size_t, std::size_t, std::string, std::size_t>;
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

PingStore::PingStore(const StoreLayout& layout)
    : layout_(layout), group_of_(groups_of_sensors(layout)), units_(layout.units()) {
  require_countable(layout_, "memory");
  for (const StoreLayout::Sensor& sensor : layout_.sensors) {
    std::vector<std::size_t>& first_byte = first_byte_.emplace_back();
    for (const OutputChannel& channel : sensor.channels) {
      first_byte.push_back(bytes_);
      bytes_ = aligned(bytes_ + sensor.pings * channel.values * sizeof(double));
    }
  }
  bytes_ = std::max(bytes_, page_bytes);
  void* data =
      mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (data == MAP_FAILED)
    throw std::runtime_error(fmt::format("memory: cannot map the pings: {}", std::strerror(errno)));
  data_ = static_cast<unsigned char*>(data);
}

PingStore::PingStore(const StoreLayout& layout, std::unique_ptr<PingFile> file, const std::string& identity)
    : layout_(layout),
      group_of_(groups_of_sensors(layout)),
      file_(std::move(file)),
      unpacked_(std::make_unique<Unpacked>()) {
  require_countable(layout_, file_->path().string());
  file_->look_through(layout_);
  file_->begin(identity, missing_bytes(layout_, *file_));
}

PingStore::~PingStore() {
  if (data_ != nullptr) munmap(data_, bytes_);
}

bool PingStore::done(std::size_t group, std::size_t ping) const {
  return file_ ? file_->has({group, ping})
               : units_[layout_.number_of({group, ping})].done.load(std::memory_order_acquire);
}

std::size_t PingStore::done_units() const {
  std::size_t all = 0;
  for (std::size_t group = 0; group < layout_.groups.size(); ++group)
    for (std::size_t ping = 0; ping < layout_.groups[group].pings; ++ping) all += done(group, ping);
  return all;
}

const OutputChannel& PingStore::channel_of(std::size_t sensor, std::string_view channel) const {
  if (const OutputChannel* found = find(sensor, channel)) return *found;
  throw std::out_of_range("no output channel " + std::string(channel));
}

std::span<double> PingStore::block(std::size_t sensor, std::string_view channel) const {
  if (file_) throw std::logic_error("packed pings are not in memory");
  const OutputChannel& found = channel_of(sensor, channel);
  const StoreLayout::Sensor& s = layout_.sensors[sensor];
  return {reinterpret_cast<double*>(data_ + first_byte_[sensor][&found - s.channels.data()]),
          s.pings * found.values};
}

std::span<double> PingStore::part(std::size_t sensor, std::size_t ping, std::string_view channel) const {
  const std::size_t values = channel_of(sensor, channel).values;
  return block(sensor, channel).subspan(ping * values, values);
}

void PingStore::finish(std::size_t group, std::size_t ping, const PingCounts& counts,
                       const PingValues& values) {
  if (file_) {
    file_->append(packed_ping(layout_, {group, ping}, counts, values));
    return;
  }
  for (const std::size_t sensor : layout_.groups[group].sensors)
    for (const OutputChannel& channel : layout_.sensors[sensor].channels)
      put_in_memory(values.of(sensor, channel.name), part(sensor, ping, channel.name));
  Unit& unit = units_[layout_.number_of({group, ping})];
  unit.counts = counts;
  unit.done.store(true, std::memory_order_release);
}

void PingStore::keep(std::string_view packed) {
  if (file_) {
    checked_contents(packed, layout_);
    file_->append(packed);
    return;
  }
  PingValues values;
  const PingCounts counts = unpack_ping(packed, layout_, values);
  const PingUnit unit = head_of_packed(packed, layout_).unit;
  finish(unit.group, unit.ping, counts, values);
}

std::shared_ptr<const double> PingStore::values(std::size_t ping, const ChunkName& name) const {
  const OutputChannel& channel = channel_of(name.sensor, name.channel);
  const std::size_t count = channel.values / channel.chunks;
  if (!file_) {
    const std::shared_ptr<const void> in_memory_anyway;
    return {in_memory_anyway, part(name.sensor, ping, name.channel).data() + name.chunk * count};
  }
  const Unpacked::Key key{name.sensor, ping, channel.name, name.chunk};
  Unpacked::Values made = unpacked_->find(key);
  if (!made) {
    made = unpacked_->room(count);
    if (!unpack_chunk(chunk(ping, name), *made))
      throw std::runtime_error(
          fmt::format("{}: ping {} can no longer be decompressed", file_->path().string(), ping));
    unpacked_->keep(key, made);
  }
  return {made, made->data()};
}

PingCounts PingStore::counts(std::size_t group, std::size_t ping) const {
  return file_ ? contents({group, ping}).counts : units_[layout_.number_of({group, ping})].counts;
}

PackedContents PingStore::contents(const PingUnit& unit) const {
  try {
    PackedContents contents =
        contents_of_packed(file_->read(unit, 0, before_chunks(layout_, unit.group)), layout_);
    if (contents.unit.group == unit.group && contents.unit.ping == unit.ping) return contents;
  } catch (const DamagedPing&) {
  }
  throw std::runtime_error(
      fmt::format("{}: ping {} has changed since it was stored", file_->path().string(), unit.ping));
}

std::vector<unsigned char> PingStore::chunk(std::size_t ping, const ChunkName& name) const {
  const std::size_t group = group_of_.at(name.sensor);
  const PackedContents::Place place = contents({group, ping}).chunks.at(chunk_number(layout_, group, name));
  const std::string bytes = file_->read({group, ping}, place.first, place.bytes);
  return {bytes.begin(), bytes.end()};
}

}  // namespace tubefoot
