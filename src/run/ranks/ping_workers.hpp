// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <thread>

#include "run/checkpoint/packed_ping.hpp"

namespace tubefoot {

/// The threads of a rank that simulate pings from a small stock, while the caller's thread sees to messages.
class PingWorkers {
 public:
  /// `run` is called by `threads` threads at once, for one ping each.
  PingWorkers(int threads, std::function<void(const PingUnit&)> run);
  /// Waits for the pings that were begun.
  ~PingWorkers();
  PingWorkers(const PingWorkers&) = delete;
  PingWorkers& operator=(const PingWorkers&) = delete;

  /// How many pings to add now: as many as keep all busy for about as long as it may take until more come, so
  /// one at a time where pings are slow; 0: enough are there.
  std::size_t wanted() const;
  void add(std::span<const PingUnit> units);
  /// No more will be added.
  void close();
  /// Leaves out those that were not begun.
  void stop();
  /// Whether nothing is left to do, or a ping failed.
  bool finished() const { return finished_; }
  bool failed() const { return failed_; }
  /// Waits for the pings that were begun; throws what one of them threw.
  void join();
  /// Sleeps until a ping is finished, no longer than `longest`.
  void rest(std::chrono::microseconds longest);

 private:
  std::optional<PingUnit> take();
  void work();

  const int threads_;
  const std::function<void(const PingUnit&)> run_;
  mutable std::mutex mutex_;
  std::condition_variable stocked_, done_;
  std::deque<PingUnit> stock_;
  std::size_t idle_ = 0, done_pings_ = 0;
  bool closed_ = false, news_ = false;
  std::optional<std::chrono::steady_clock::time_point> begun_;
  std::exception_ptr error_;
  std::atomic<bool> finished_{false}, failed_{false};
  std::thread thread_;
};

}  // namespace tubefoot
