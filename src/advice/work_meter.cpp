// SPDX-License-Identifier: GPL-3.0-or-later
#include "advice/work_meter.hpp"

#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>
#include <ctime>

namespace tubefoot {
namespace {

int open_counter() {
  perf_event_attr requested{};
  requested.type = PERF_TYPE_HARDWARE;
  requested.size = sizeof(requested);
  requested.config = PERF_COUNT_HW_INSTRUCTIONS;
  requested.exclude_kernel =
      1;  // users may count only user mode by default, and clearing of pages by the system is excluded
  requested.exclude_hv = 1;
  constexpr int this_thread = 0, any_processor = -1, no_group = -1;
  return static_cast<int>(
      syscall(SYS_perf_event_open, &requested, this_thread, any_processor, no_group, PERF_FLAG_FD_CLOEXEC));
}

}  // namespace

WorkMeter::WorkMeter() : counter_(open_counter()) { start(); }

double WorkMeter::processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double WorkMeter::instructions() const {
  std::uint64_t count = 0;
  if (!counter_ || read(counter_.number(), &count, sizeof(count)) != sizeof(count)) return 0;
  return static_cast<double>(count);
}

void WorkMeter::start() {
  start_ = std::chrono::steady_clock::now();
  start_processor_seconds_ = processor_seconds();
  start_instructions_ = instructions();
}

PingWork WorkMeter::since_start() const {
  PingWork work;
  work.instructions = instructions() - start_instructions_;
  work.processor_seconds = processor_seconds() - start_processor_seconds_;
  work.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  return work;
}

}  // namespace tubefoot
