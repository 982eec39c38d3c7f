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

/// The threads of a rank that simulate pings from a small stock, while the calling thread handles messages.
class PingWorkers {
 public:
  /// `threads` threads call `run` concurrently, each for one ping.
  PingWorkers(int threads, std::function<void(const PingUnit&)> run);
  /// Waits for the pings in progress.
  ~PingWorkers();
  PingWorkers(const PingWorkers&) = delete;
  PingWorkers& operator=(const PingWorkers&) = delete;

  /// Returns the number of pings to add now. This number keeps all threads busy for about the time until the
  /// next pings can arrive. Slow pings are therefore requested one at a time. It is 0 if the stock suffices.
  std::size_t wanted() const;
  void add(std::span<const PingUnit> units);
  /// Announces that no more pings follow.
  void close();
  /// Discards the pings that were not started.
  void stop();
  /// Returns whether no work is left, or a ping failed.
  bool finished() const { return finished_; }
  bool failed() const { return failed_; }
  /// Waits for the pings in progress, and throws the exception of a failed ping.
  void join();
  /// Sleeps until a ping is finished, but no longer than `longest`.
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
