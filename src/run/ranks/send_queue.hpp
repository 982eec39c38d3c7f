// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

namespace tubefoot {

/// Results of a rank's threads on their way to its link. Where the link is slower than the threads these
/// wait, so that what is not sent yet takes no more memory than the send queue was given, and one result a
/// thread.
class SendQueue {
 public:
  explicit SendQueue(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  /// Waits for room. Called by the threads.
  void put(std::string result);
  /// What was put since, in order. `unsent`: bytes that the link still holds of what was taken before.
  std::vector<std::string> take(std::size_t unsent);
  /// Nobody waits from now on.
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
