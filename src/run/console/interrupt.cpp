// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/console/interrupt.hpp"

#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <initializer_list>
#include <string_view>

#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

void set(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;  // libraries do not expect calls that end early
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

bool is_ignored(int signal) {
  struct sigaction now {};
  return sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

void note(int) {
  const int before = errno;
  if (!stop_asked.exchange(true)) {
    for (const int signal : {SIGINT, SIGTERM})
      if (!is_ignored(signal)) set(signal, SIG_DFL);
    constexpr std::string_view hint = "\nstopping; once more: stopping at once\n";
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, hint.data(), hint.size());
  }
  errno = before;
}

}  // namespace

void take_signals() {
  for (const int signal : {SIGPIPE, SIGXFSZ}) set(signal, SIG_IGN);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGXCPU})
    if (!is_ignored(signal)) set(signal, note);
}

}  // namespace tubefoot
