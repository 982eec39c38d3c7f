// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace tubefoot {

/// Progress on stderr: a bar with an estimate of the time left on a terminal, a plain line every tenth
/// otherwise, nothing if quiet. Thread-safe.
class Progress {
 public:
  Progress(std::string what, std::size_t total, bool quiet);
  ~Progress();
  void step();

 private:
  void draw(std::size_t finished, double seconds) const;

  std::string what_;
  std::size_t total_, finished_ = 0, shown_tenths_ = 0;
  bool quiet_, terminal_;
  std::chrono::steady_clock::time_point start_, drawn_;
  std::mutex mutex_;
};

}  // namespace tubefoot
