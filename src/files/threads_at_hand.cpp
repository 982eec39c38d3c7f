// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/threads_at_hand.hpp"

#include <pthread.h>
#include <sys/resource.h>

#include <algorithm>
#include <latch>
#include <mutex>
#include <system_error>
#include <vector>

#include "files/memory_at_hand.hpp"

namespace tubefoot {
namespace {

/// Number of threads reserved for progress and for libraries that may end the program without them: fonts,
/// and four of OpenImageIO.
constexpr int for_libraries = 9;
constexpr std::size_t stack_bytes = std::size_t{4} << 20;  // the stack size of oneTBB's threads
/// Address space per thread, with its share of buffers.
constexpr double bytes_per_thread = 64 << 20;

void* wait_for_end(void* end) {
  static_cast<std::latch*>(end)->wait();
  return nullptr;
}

/// Starts up to `wanted` threads, ends them, and returns their number.
int startable(int wanted) {
  std::latch end(1);
  std::vector<pthread_t> started;
  started.reserve(static_cast<std::size_t>(std::max(wanted, 0)));
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, stack_bytes);
  pthread_t thread{};
  while (static_cast<int>(started.size()) < wanted &&
         pthread_create(&thread, &attributes, wait_for_end, &end) == 0)
    started.push_back(thread);
  pthread_attr_destroy(&attributes);
  end.count_down();
  for (const pthread_t& one : started) pthread_join(one, nullptr);
  return static_cast<int>(started.size());
}

}  // namespace

int threads_at_hand(int wanted) {
  // oneTBB keeps started threads, which must not reduce the number in a later call.
  static std::mutex mutex;
  static int most = 1;
  static bool no_more = false;
  const std::lock_guard lock(mutex);
  if (wanted > most && !no_more) {
    int others = wanted - 1;
    if (rlimit limit{}; getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
      others = static_cast<int>(std::min<double>(others, memory_at_hand() / 2 / bytes_per_thread));
    most = 1 + std::clamp(startable(others + for_libraries) - for_libraries, 0, others);
    no_more = most < wanted;
  }
  return std::clamp(wanted, 1, most);
}

void require_threads(int count) {
  if (startable(count) < count)
    throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
}

}  // namespace tubefoot
