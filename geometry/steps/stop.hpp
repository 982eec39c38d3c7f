// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>

// Requests to stop, which long work checks. A check costs two loads.
namespace tubefoot {

/// Thrown out of work that is left unfinished because a stop is requested. It is no std::exception, so that
/// code that handles errors, for example by a second attempt or by a message, does not catch it.
struct Interrupted {};

/// Requests all work of the process to stop. Signal handlers set it.
inline std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free);

/// Requests the work of this thread alone to stop; null if nothing can request that.
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
