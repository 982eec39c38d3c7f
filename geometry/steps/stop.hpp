// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>

// What long work looks at, so that nobody waits for it who no longer wants it. A look costs two loads.
namespace tubefoot {

/// Thrown out of work that is left unfinished because somebody wants to stop. No std::exception: nothing
/// that takes an error for a try that failed, or puts words to it, is to catch it.
struct Interrupted {};

/// Asked of all work of the process. Signal handlers set it.
inline std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free);

/// Asked of the work that a thread takes part in alone; null: of none.
inline constinit thread_local const std::atomic<bool>* stop_requested_of_thread = nullptr;

inline bool stop_wanted() {
  return stop_requested.load(std::memory_order_relaxed) ||
         (stop_requested_of_thread != nullptr && stop_requested_of_thread->load(std::memory_order_relaxed));
}

inline void stop_if_wanted() {
  if (stop_wanted()) [[unlikely]]
    throw Interrupted();
}

}  // namespace tubefoot
