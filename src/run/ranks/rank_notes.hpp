// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "run/checkpoint/ping_store.hpp"
#include "run/ranks/ping_workers.hpp"

// This header declares the messages between ranks (docs/large-jobs.md). A message is one letter, followed by
// its contents.
namespace tubefoot {

enum class Note : char {
  start = 's',       ///< from rank 0: the run, as JSON
  pings = 'p',       ///< from rank 0: units to simulate; an empty list means that no more follow
  stop = 'x',        ///< from rank 0, once to each rank: leave
  wanted = 'w',      ///< to rank 0: number of requested pings
  result = 'r',      ///< to rank 0: a packed ping
  failed = 'f',      ///< to rank 0, the last message before stop: an error
  done = 'd',        ///< to rank 0, the last message before stop
  interrupted = 'i'  ///< in place of done: the user interrupted this rank
};

/// Returns the kind of a message. Throws std::runtime_error for an empty message.
Note note_of(std::string_view message);

std::string note(Note kind, std::string_view text = {});
std::string wanted_note(std::size_t count);
std::size_t count_in(std::string_view message);
std::string pings_note(std::span<const PingUnit> units);
std::vector<PingUnit> units_in(std::string_view message);

std::string result_note(const StoreLayout& layout, const PingUnit& unit, const PingCounts& counts,
                        const PingValues& values);
/// Stores a ping as it was packed. Throws std::runtime_error if the ping does not belong to this run.
/// Returns whether the ping is new.
bool take_result(std::string_view message, const StoreLayout& layout, PingStore& store);

/// Returns a message with the error, which rank 0 throws again.
std::string failed_note(const std::exception& error);
[[noreturn]] void rethrow(std::string_view failed_message);

}  // namespace tubefoot
