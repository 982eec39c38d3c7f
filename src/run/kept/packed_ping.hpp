// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "run/kept/ping_store.hpp"

// A finished ping in few bytes, in one form for all who carry pings about: ranks send it to each other, parts
// of a run keep it in their files. The same bytes on any thread of the same build.
namespace tubefoot {

/// A ping of a group of sensors.
struct PingUnit {
  std::uint64_t group = 0, ping = 0;
};

/// Bytes that are no packed ping of this run.
struct DamagedPing : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What goes before a ping's packed values.
struct PackedHead {
  PingUnit unit;
  std::uint64_t bytes = 0;  ///< of the packed values, which follow
  std::uint32_t values_checksum = 0, head_checksum = 0;
};

/// Room for one ping of one group: its slot 0.
StoreLayout room_for_one(StoreLayout layout, std::size_t group);

/// A ping that is slot `slot` of a store: a PackedHead, then its counts, energies and bounds. Throws
/// std::bad_alloc.
std::string packed_ping(const StoreLayout& layout, const PingUnit& unit, const PingCounts& counts,
                        PingStore& store, std::size_t slot);

/// The head that some bytes begin with. Throws DamagedPing where there is none, or one of a ping that the
/// layout has not, or of more bytes than such a ping can be packed into.
PackedHead head_of_packed(std::string_view bytes, const StoreLayout& layout);
/// Whether packed values are those that their head belongs to.
bool belongs_to(const PackedHead& head, std::string_view values);

/// Leaves a packed ping's energies and bounds where they belong in a store of all pings, for its finish(), to
/// which the counts go. Takes no memory beyond what such a ping has unpacked. Throws DamagedPing; what it
/// leaves in the ping's place then is anything.
PingCounts unpack_ping(std::string_view packed, const StoreLayout& layout, PingStore& store);

}  // namespace tubefoot
