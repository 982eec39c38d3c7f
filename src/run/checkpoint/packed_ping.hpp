// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "run/checkpoint/ping_counts.hpp"
#include "run/checkpoint/ping_values.hpp"

// A finished ping in few bytes, in one form for all who carry pings about: a run keeps it until its files are
// written, ranks send it to each other, parts of a run keep it in their files. Each channel of each sensor is
// a chunk of echoes.nc (files/hdf5_chunks.hpp), packed by who made the ping. The same bytes on any thread of
// the same build.
namespace tubefoot {

/// Bytes that are no packed ping of this run.
struct DamagedPing : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What goes before a ping's counts and chunks.
struct PackedHead {
  PingUnit unit;
  std::uint64_t bytes = 0;  ///< of what follows
  std::uint32_t values_checksum = 0, head_checksum = 0;
};

/// One of a ping's values: energies, or the bounds of a reference.
struct ChunkName {
  std::size_t sensor = 0, channel = 0;
  bool bound = false;
};

/// A PackedHead, a ping's counts, the lengths of its chunks, then these. Throws std::bad_alloc.
std::string packed_ping(const StoreLayout& layout, const PingUnit& unit, const PingCounts& counts,
                        const PingValues& values);

/// The head that some bytes begin with. Throws DamagedPing where there is none, or one of a ping that the
/// layout has not, or of more bytes than such a ping can be packed into.
PackedHead head_of_packed(std::string_view bytes, const StoreLayout& layout);
/// Whether packed values are those that their head belongs to.
bool belongs_to(const PackedHead& head, std::string_view values);

/// The most bytes of a packed ping of a group, head included.
std::size_t most_packed(const StoreLayout& layout, std::size_t group);
/// Those before its first chunk, of any ping of the group.
std::size_t before_chunks(const StoreLayout& layout, std::size_t group);
/// How many chunks of its group's pings come before this one.
std::size_t chunk_number(const StoreLayout& layout, std::size_t group, const ChunkName& name);

/// What a packed ping says of itself before its chunks.
struct PackedContents {
  PingUnit unit;
  PingCounts counts;
  struct Place {
    std::size_t first = 0, bytes = 0;
  };
  std::vector<Place> chunks;  ///< where they lie in the ping's bytes
};
/// `beginning`: before_chunks() bytes, or more. Throws DamagedPing where the lengths are not those of such a
/// ping. What its chunks hold is found out as they are unpacked.
PackedContents contents_of_packed(std::string_view beginning, const StoreLayout& layout);
/// The same of a whole ping, whose sums must fit.
PackedContents checked_contents(std::string_view packed, const StoreLayout& layout);

/// Leaves a packed ping's energies and bounds in `values`, for a store's finish(), to which the counts go.
/// Takes no memory beyond what such a ping has unpacked. Throws DamagedPing.
PingCounts unpack_ping(std::string_view packed, const StoreLayout& layout, PingValues& values);

}  // namespace tubefoot
