// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>

#include "files/descriptor.hpp"
#include "study/work_precision.hpp"

namespace tubefoot {

/// Measures the work of the calling thread between two moments. The performance counter of the processor
/// counts instructions (perf_event_open(2)). Virtual machines often lack it, and systems may restrict it;
/// the count is then 0.
class WorkMeter {
 public:
  WorkMeter();
  void start();
  PingWork since_start() const;

 private:
  /// Processor seconds and instructions of this thread since an arbitrary moment.
  static double processor_seconds();
  double instructions() const;

  Descriptor counter_;  ///< closed if instructions are not counted
  std::chrono::steady_clock::time_point start_;
  double start_processor_seconds_ = 0, start_instructions_ = 0;
};

}  // namespace tubefoot
