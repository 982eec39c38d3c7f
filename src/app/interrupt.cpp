// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/interrupt.hpp"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <string_view>

namespace tubefoot {
namespace {

/// Set in a signal handler, read by every thread.
std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free);

/// The first time asks; the second time, by whichever signal, ends the program where it stands.
void note(int) {
  interrupted = true;
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  constexpr std::string_view hint = "\nstopping after the pings under way; once more: stopping at once\n";
  const int before = errno;
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, hint.data(), hint.size());
  errno = before;
}

}  // namespace

InterruptGuard::InterruptGuard() {
  interrupted = false;
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
}

InterruptGuard::~InterruptGuard() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

bool InterruptGuard::requested() { return interrupted; }

void InterruptGuard::request() { interrupted = true; }

}  // namespace tubefoot
