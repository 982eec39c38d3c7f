// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/interrupt.hpp"

#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <string_view>

namespace tubefoot {
namespace {

volatile std::sig_atomic_t interrupted = 0;

/// The first time asks; the second time, by whichever signal, ends the program where it stands.
void note(int) {
  interrupted = 1;
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  constexpr std::string_view hint = "\nstopping after the pings under way; once more: stopping at once\n";
  const int before = errno;
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, hint.data(), hint.size());
  errno = before;
}

}  // namespace

InterruptGuard::InterruptGuard() {
  interrupted = 0;
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
}

InterruptGuard::~InterruptGuard() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

bool InterruptGuard::requested() { return interrupted != 0; }

void InterruptGuard::request() { interrupted = 1; }

}  // namespace tubefoot
