// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

namespace tubefoot {

/// Results of a rank's threads that wait to be sent. If the link is slower than the threads, the threads
/// wait. Unsent results therefore take no more memory than the limit of the queue, and one result per
/// thread.
class SendQueue {
 public:
  explicit SendQueue(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  /// Adds a result. Waits for free capacity. Called by the worker threads.
  void put(std::string result);
  /// Returns the results since the last call, in order. `unsent`: number of bytes of earlier results that
  /// the link still holds.
  std::vector<std::string> take(std::size_t unsent);
  /// Removes the limit: from now on no thread waits.
  void open();

 private:
  const std::size_t most_bytes_;
  std::mutex mutex_;
  std::condition_variable room_;
  std::vector<std::string> results_;
  std::size_t held_bytes_ = 0, unsent_bytes_ = 0;
  bool open_ = false;
};

}  // namespace tubefoot
