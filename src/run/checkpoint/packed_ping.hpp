// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "run/checkpoint/ping_counts.hpp"
#include "run/checkpoint/ping_values.hpp"

// This header declares the compact form of a finished ping. A run keeps this form until its files are
// written. Ranks send it to each other, and shards store it in their files. Each output channel of each
// sensor consists of chunks of echoes.nc (files/hdf5_chunks.hpp); the process that computed the ping packs
// them. Every thread of the same build produces the same bytes.
namespace tubefoot {

/// Error for bytes that are not a packed ping of this run.
struct DamagedPing : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Header that precedes the counts and the chunks of a ping.
struct PackedHead {
  PingUnit unit;
  std::uint64_t bytes = 0;  ///< number of bytes after the header
  std::uint32_t values_checksum = 0, head_checksum = 0;
};

/// Name of one chunk of a ping's values.
struct ChunkName {
  std::size_t sensor = 0;
  std::string_view channel;
  std::size_t chunk = 0;  ///< number of the chunk within the channel
};

/// Returns a PackedHead, the counts of the ping, the lengths of its chunks, and the chunks. Throws
/// std::bad_alloc.
std::string packed_ping(const StoreLayout& layout, const PingUnit& unit, const PingCounts& counts,
                        const PingValues& values);

/// Returns the header at the start of `bytes`, or nothing if there is none. The header may belong to another
/// layout.
std::optional<PackedHead> intact_head(std::string_view bytes);
/// Returns the header at the start of `bytes`. Throws DamagedPing if there is no header or if the layout
/// does not contain the ping. Also throws DamagedPing if the ping has more bytes than such a ping can have
/// when packed.
PackedHead head_of_packed(std::string_view bytes, const StoreLayout& layout);
/// Returns whether the packed values belong to the header, by their checksum.
bool belongs_to(const PackedHead& head, std::string_view values);

/// Returns the largest possible number of bytes of a packed ping of a group, header included.
std::size_t most_packed(const StoreLayout& layout, std::size_t group);
/// Returns the number of bytes before the first chunk, which is the same for all pings of the group.
std::size_t before_chunks(const StoreLayout& layout, std::size_t group);
/// Returns the number of chunks of the group's pings that precede this chunk. Throws std::out_of_range if
/// there is no such chunk.
std::size_t chunk_number(const StoreLayout& layout, std::size_t group, const ChunkName& name);

/// Contents of a packed ping, apart from its chunks.
struct PackedContents {
  PingUnit unit;
  PingCounts counts;
  struct Place {
    std::size_t first = 0, bytes = 0;
  };
  std::vector<Place> chunks;  ///< positions of the chunks in the bytes of the ping
};
/// Returns the contents of a packed ping. `beginning` contains at least before_chunks() bytes. Throws
/// DamagedPing if the chunk lengths do not fit the layout. Errors in the chunks themselves appear when they
/// are unpacked.
PackedContents contents_of_packed(std::string_view beginning, const StoreLayout& layout);
/// Returns the contents of a complete packed ping, and checks its checksums.
PackedContents checked_contents(std::string_view packed, const StoreLayout& layout);

/// Unpacks the values of a ping into `values`, for finish() of a store, and returns its counts.
/// Needs no memory beyond the unpacked values of such a ping. Throws DamagedPing.
PingCounts unpack_ping(std::string_view packed, const StoreLayout& layout, PingValues& values);

}  // namespace tubefoot
