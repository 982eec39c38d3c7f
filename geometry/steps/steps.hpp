// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <optional>

#include "geometry/steps/stop.hpp"

namespace tubefoot {

/// The steps of one piece of long work. They make the work interruptible and report its progress. Any number
/// of Steps may exist at a time, nested or in several threads.
class Steps {
 public:
  /// `what` names the steps, for example "tubes". The string must outlive the object.
  Steps(const char* what, std::size_t total);
  ~Steps();
  Steps(const Steps&) = delete;
  Steps& operator=(const Steps&) = delete;

  /// Counts one step; callable on any thread. Throws Interrupted if a stop is requested.
  void done() {
    done_.fetch_add(1, std::memory_order_relaxed);
    stop_if_wanted();
  }

  /// Progress of the oldest running work, added up with all work of the same name.
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
  Steps *before_ = nullptr, *after_ = nullptr;  ///< list of running work, in order of time
};

}  // namespace tubefoot
