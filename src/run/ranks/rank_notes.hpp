// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "run/checkpoint/ping_store.hpp"
#include "run/ranks/ping_workers.hpp"

// What ranks tell each other (docs/cluster.md): a letter, then what belongs to it.
namespace tubefoot {

enum class Note : char {
  start = 's',       ///< from rank 0: what is run, JSON
  pings = 'p',       ///< from rank 0: units to simulate; none: there are no more
  stop = 'x',        ///< from rank 0, once to each: leave
  wanted = 'w',      ///< to rank 0: how many pings
  result = 'r',      ///< to rank 0: a packed ping
  failed = 'f',      ///< to rank 0, the last but stop: an error
  done = 'd',        ///< to rank 0, the last but stop
  interrupted = 'i'  ///< in place of done: the user asked this rank to stop
};

/// Throws std::runtime_error for an empty message.
Note note_of(std::string_view message);

std::string note(Note kind, std::string_view text = {});
std::string wanted_note(std::size_t count);
std::size_t count_in(std::string_view message);
std::string pings_note(std::span<const PingUnit> units);
std::vector<PingUnit> units_in(std::string_view message);

std::string result_note(const StoreLayout& layout, const PingUnit& unit, const PingCounts& counts,
                        const PingValues& values);
/// Keeps a ping as it was packed. Throws std::runtime_error if it is none of this run. Returns whether it is
/// new.
bool take_result(std::string_view message, const StoreLayout& layout, PingStore& store);

/// What is being thrown, for rank 0 to throw it again.
std::string failed_note(const std::exception& error);
[[noreturn]] void rethrow(std::string_view failed_message);

}  // namespace tubefoot
