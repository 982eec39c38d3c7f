// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/checkpoint/packed_ping.hpp"

#include <libdeflate.h>

#include <cstddef>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <type_traits>

#include "files/hdf5_chunks.hpp"

// This file packs the output channels and counts of a finished ping into bytes, and unpacks and checks them.
// The bytes consist of a PackedHead with checksums, the counts, the lengths of the chunks, and the chunks.

namespace tubefoot {
namespace {

static_assert(std::is_trivially_copyable_v<PingCounts> && sizeof(PackedHead) == 32);

std::uint32_t checksum_of(const PackedHead& head) {
  return libdeflate_crc32(0, &head, offsetof(PackedHead, head_checksum));
}

[[noreturn]] void damaged(const char* why) { throw DamagedPing(why); }

/// Calls each(name of the chunk, number of its values) for the chunks of a group's pings. Their order is by
/// sensor, then by output channel.
template <class Each>
void each_chunk(const StoreLayout& layout, std::size_t group, const Each& each) {
  for (const std::size_t sensor : layout.groups.at(group).sensors)
    for (const OutputChannel& channel : layout.sensors.at(sensor).channels)
      for (std::size_t chunk = 0; chunk < channel.chunks; ++chunk)
        each(ChunkName{sensor, channel.name, chunk}, channel.values / channel.chunks);
}

std::size_t chunks_of(const StoreLayout& layout, std::size_t group) {
  std::size_t chunks = 0;
  each_chunk(layout, group, [&](const ChunkName&, std::size_t) { ++chunks; });
  return chunks;
}

auto values_of(auto& values, const ChunkName& name, std::size_t count) {
  return values.of(name.sensor, name.channel).subspan(name.chunk * count, count);
}

}  // namespace

std::size_t before_chunks(const StoreLayout& layout, std::size_t group) {
  return sizeof(PackedHead) + sizeof(PingCounts) + chunks_of(layout, group) * sizeof(std::uint64_t);
}

std::size_t most_packed(const StoreLayout& layout, std::size_t group) {
  std::size_t bytes = before_chunks(layout, group);
  each_chunk(layout, group, [&](const ChunkName&, std::size_t count) { bytes += most_packed_bytes(count); });
  return bytes;
}

std::size_t chunk_number(const StoreLayout& layout, std::size_t group, const ChunkName& name) {
  std::size_t number = 0;
  std::optional<std::size_t> found;
  each_chunk(layout, group, [&](const ChunkName& other, std::size_t) {
    if (other.sensor == name.sensor && other.channel == name.channel && other.chunk == name.chunk)
      found = number;
    ++number;
  });
  if (!found) throw std::out_of_range("no output channel " + std::string(name.channel));
  return *found;
}

std::string packed_ping(const StoreLayout& layout, const PingUnit& unit, const PingCounts& counts,
                        const PingValues& values) {
  std::string packed(before_chunks(layout, unit.group), '\0');
  std::size_t length_at = sizeof(PackedHead) + sizeof counts;
  std::memcpy(packed.data() + sizeof(PackedHead), &counts, sizeof counts);
  each_chunk(layout, unit.group, [&](const ChunkName& name, std::size_t count) {
    const std::vector<unsigned char> chunk = packed_chunk(values_of(values, name, count));
    const std::uint64_t length = chunk.size();
    std::memcpy(packed.data() + length_at, &length, sizeof length);
    length_at += sizeof length;
    packed.append(reinterpret_cast<const char*>(chunk.data()), chunk.size());
  });
  PackedHead head{unit};
  const std::string_view body = std::string_view(packed).substr(sizeof head);
  head.bytes = body.size();
  head.values_checksum = libdeflate_crc32(0, body.data(), body.size());
  head.head_checksum = checksum_of(head);
  std::memcpy(packed.data(), &head, sizeof head);
  return packed;
}

std::optional<PackedHead> intact_head(std::string_view bytes) {
  PackedHead head;
  if (bytes.size() < sizeof head) return std::nullopt;
  std::memcpy(&head, bytes.data(), sizeof head);
  if (head.head_checksum != checksum_of(head)) return std::nullopt;
  return head;
}

PackedHead head_of_packed(std::string_view bytes, const StoreLayout& layout) {
  const std::optional<PackedHead> intact = intact_head(bytes);
  if (!intact) damaged("its header is incomplete or damaged");
  const PackedHead& head = *intact;
  if (head.unit.group >= layout.groups.size() || head.unit.ping >= layout.groups[head.unit.group].pings)
    damaged("it belongs to another run");
  if (head.bytes > most_packed(layout, head.unit.group) - sizeof head) damaged("it is too long");
  return head;
}

bool belongs_to(const PackedHead& head, std::string_view values) {
  return values.size() == head.bytes &&
         head.values_checksum == libdeflate_crc32(0, values.data(), values.size());
}

PackedContents contents_of_packed(std::string_view beginning, const StoreLayout& layout) {
  const PackedHead head = head_of_packed(beginning, layout);
  const std::size_t group = head.unit.group;
  PackedContents contents{head.unit, {}, {}};
  std::size_t next = before_chunks(layout, group);
  const std::size_t end = sizeof head + head.bytes;
  if (beginning.size() < next || end < next) damaged("it is too short");
  std::memcpy(&contents.counts, beginning.data() + sizeof head, sizeof contents.counts);
  const char* length_at = beginning.data() + sizeof head + sizeof contents.counts;
  each_chunk(layout, group, [&](const ChunkName&, std::size_t) {
    std::uint64_t length = 0;
    std::memcpy(&length, length_at, sizeof length);
    length_at += sizeof length;
    if (length > end - next) damaged("it ends too early");
    contents.chunks.push_back({next, length});
    next += length;
  });
  if (next != end) damaged("its length differs");
  return contents;
}

PackedContents checked_contents(std::string_view packed, const StoreLayout& layout) {
  const PackedHead head = head_of_packed(packed, layout);
  if (!belongs_to(head, packed.substr(sizeof head))) damaged("its values are damaged");
  return contents_of_packed(packed, layout);
}

PingCounts unpack_ping(std::string_view packed, const StoreLayout& layout, PingValues& values) {
  const PackedContents contents = checked_contents(packed, layout);
  values.clear(layout, contents.unit.group);
  auto place = contents.chunks.begin();
  each_chunk(layout, contents.unit.group, [&](const ChunkName& name, std::size_t count) {
    const std::string_view chunk = packed.substr(place->first, place->bytes);
    ++place;
    if (!unpack_chunk({reinterpret_cast<const unsigned char*>(chunk.data()), chunk.size()},
                      values_of(values, name, count)))
      damaged("it cannot be decompressed");
  });
  return contents.counts;
}

}  // namespace tubefoot
