// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/console/exhausted.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <new>
#include <system_error>

#include "files/memory_at_hand.hpp"
#include "run/console/on_demand.hpp"

// This file recognises errors that mean that memory or threads are exhausted, and replaces their text by a
// message that names the limit. It also checks the address space before the initializers of the libraries
// run.

namespace tubefoot {
namespace {

constexpr std::string_view out_of_memory =
    "out of memory: raise the limit, or use fewer --threads, a window of the terrain, a coarser decimation "
    "or a smaller scene";
constexpr std::string_view no_threads =
    "cannot start a thread: too little memory (ulimit -v) or too many processes (ulimit -u, the limit of a "
    "container)";

constexpr rlim_t mb = rlim_t{1} << 20;
/// Memory and threads that the initializers of libraries need, with a reserve. All libraries, including those
/// on demand, need 31 MB on Debian 12. The dependency log4cplus of OpenImageIO starts the threads.
constexpr rlim_t library_bytes = 96 * mb, library_threads = 4;

bool addresses_are_limited() {
  rlimit limit{};
  return getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
}

std::terminate_handler otherwise = nullptr;

/// Allocates no memory.
[[noreturn]] void end_in_words() {
  std::string_view words;
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::exception& error) {
    words = exhaustion_in_words(error);
    if (dynamic_cast<const LibraryMissing*>(&error) != nullptr) words = error.what();
  } catch (...) {
    words = {};
  }
  if (!words.empty()) {
    for (const std::string_view part : {std::string_view("tubefoot: "), words, std::string_view("\n")}) {
      [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, part.data(), part.size());
    }
    _exit(1);
  }
  otherwise();
  std::abort();
}

}  // namespace

std::string_view exhaustion_in_words(const std::exception& error) {
  const std::string_view text = error.what();
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr || text.find("std::bad_alloc") != text.npos)
    return out_of_memory;
  if (const auto* system = dynamic_cast<const std::system_error*>(&error)) {
    if (system->code() == std::errc::not_enough_memory) return out_of_memory;
    if (system->code() == std::errc::resource_unavailable_try_again) return no_threads;
  }
  // Text of oneTBB's exception.
  if (text.starts_with("pthread_create")) return no_threads;
  return {};
}

void before_libraries_start() {
  otherwise = std::set_terminate(end_in_words);
  rlimit addresses{}, stack{};
  if (getrlimit(RLIMIT_AS, &addresses) != 0 || addresses.rlim_cur == RLIM_INFINITY) return;
  if (getrlimit(RLIMIT_STACK, &stack) != 0 || stack.rlim_cur == RLIM_INFINITY) stack.rlim_cur = 2 * mb;
  // The C++ library is not initialized at this point, so that this code uses system calls and the C library
  // only.
  char text[256]{};
  const int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (file < 0) return;
  const ssize_t count = read(file, text, sizeof text - 1);
  close(file);
  if (count <= 0) return;
  const rlim_t taken = std::strtoull(text, nullptr, 10) * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)),
               left = addresses.rlim_cur > taken ? addresses.rlim_cur - taken : 0,
               needed = library_bytes + library_threads * stack.rlim_cur;
  if (left >= needed) return;
  const int length =
      std::snprintf(text, sizeof text,
                    "tubefoot: out of memory: the libraries need %llu MB of address space, but %llu MB are "
                    "left: raise the limit (ulimit -v)\n",
                    static_cast<unsigned long long>(needed / mb), static_cast<unsigned long long>(left / mb));
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text, static_cast<std::size_t>(length));
  _exit(1);
}

void configure_heap() {
  constexpr int kept_bytes = 128 << 20, largest_block_bytes = 32 << 20;  // the second is glibc's maximum
  mallopt(M_TRIM_THRESHOLD, kept_bytes);
  mallopt(M_MMAP_THRESHOLD, largest_block_bytes);
  if (addresses_are_limited() && memory_at_hand() < 16e9) mallopt(M_ARENA_MAX, 1);
}

}  // namespace tubefoot
