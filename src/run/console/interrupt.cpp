// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/console/interrupt.hpp"

#include <poll.h>
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
  action.sa_flags = SA_RESTART;  // libraries do not expect interrupted system calls
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

bool is_ignored(int signal) {
  struct sigaction now {};
  return sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

/// Time in which work must stop before the program ends immediately.
constexpr unsigned patience_s = 5;
/// The first signal that requested a stop.
volatile std::sig_atomic_t requested_by = 0;

/// Omits the message if a stopped terminal or a full pipe would block the program.
void say_without_waiting(std::string_view words) {
  pollfd terminal{STDERR_FILENO, POLLOUT, 0};
  if (poll(&terminal, 1, 0) != 1 || (terminal.revents & POLLOUT) == 0) return;
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, words.data(), words.size());
}

/// Ends the program by `signal` with its default action.
void end_by(int signal) {
  set(signal, SIG_DFL);
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, signal);
  pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
  raise(signal);
}

/// Handler of alarm(): the time to stop has passed.
void end_now(int) {
  say_without_waiting("\nterminating: the work did not stop within 5 s\n");
  end_by(requested_by);
}

void note(int signal) {
  const int before = errno;
  if (!stop_requested.exchange(true)) {
    requested_by = signal;
    for (const int other : {SIGINT, SIGTERM})
      if (!is_ignored(other)) set(other, SIG_DFL);
    // Work that waits in a library or in a system call does not check the flag.
    set(SIGALRM, end_now);
    if (const unsigned left = alarm(patience_s); left != 0 && left < patience_s) alarm(left);
    say_without_waiting("\nstopping; a second signal stops immediately\n");
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
