// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>

#include "files/descriptor.hpp"
#include "study/work_precision.hpp"

namespace tubefoot {

/// What the calling thread does between two moments. Instructions are those of the processor's counter
/// (perf_event_open(2)), which virtual machines often lack and systems may keep to themselves: 0 then.
class WorkMeter {
 public:
  WorkMeter();
  void start();
  PingWork since_start() const;

 private:
  /// Both of this thread, since some moment.
  static double processor_seconds();
  double instructions() const;

  Descriptor counter_;  ///< closed where instructions are not counted
  std::chrono::steady_clock::time_point start_;
  double start_processor_seconds_ = 0, start_instructions_ = 0;
};

}  // namespace tubefoot
