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

/// A PackedHead, then a ping's counts, energies and bounds. Throws std::bad_alloc.
std::string packed_ping(const StoreLayout& layout, const PingUnit& unit, const PingCounts& counts,
                        const PingValues& values);

/// The head that some bytes begin with. Throws DamagedPing where there is none, or one of a ping that the
/// layout has not, or of more bytes than such a ping can be packed into.
PackedHead head_of_packed(std::string_view bytes, const StoreLayout& layout);
/// Whether packed values are those that their head belongs to.
bool belongs_to(const PackedHead& head, std::string_view values);

/// Leaves a packed ping's energies and bounds in `values`, for a store's finish(), to which the counts go.
/// Takes no memory beyond what such a ping has unpacked. Throws DamagedPing.
PingCounts unpack_ping(std::string_view packed, const StoreLayout& layout, PingValues& values);

}  // namespace tubefoot
