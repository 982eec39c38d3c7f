// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <optional>

#include "geometry/steps/stop.hpp"

namespace tubefoot {

/// The steps of one piece of work that may take long: where it can be stopped, and how far it is. Any number
/// may be at hand at a time, one within another or in several threads.
class Steps {
 public:
  /// `what` they are, in a word that outlives them: "tubes".
  Steps(const char* what, std::size_t total);
  ~Steps();
  Steps(const Steps&) = delete;
  Steps& operator=(const Steps&) = delete;

  /// One is done, on any thread. Throws Interrupted if somebody wants to stop.
  void done() {
    done_.fetch_add(1, std::memory_order_relaxed);
    stop_if_wanted();
  }

  /// The work that has been at hand for longest, together with all of the same name.
  struct AtHand {
    const char* what;
    std::size_t done, total;
    std::chrono::steady_clock::time_point since;
  };
  static std::optional<AtHand> at_hand();

 private:
  const char* what_;
  std::size_t total_;
  std::atomic<std::size_t> done_{0};
  std::chrono::steady_clock::time_point since_;
  Steps *before_ = nullptr, *after_ = nullptr;  ///< of those at hand, in order of time
};

}  // namespace tubefoot
