// SPDX-License-Identifier: GPL-3.0-or-later

// Runs work in a forked process with limits of processor time, memory and open files, and reads its result
// through a pipe.

#include "scene/meshes/mesh_file_apart.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string_view>
#include <system_error>

#include "files/input_registry.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

void limit(__rlimit_resource resource, double most) {
  rlimit limits{};
  getrlimit(resource, &limits);
  const auto wanted = static_cast<rlim_t>(most);
  limits.rlim_cur = std::min(limits.rlim_max, wanted);
  limits.rlim_max = limits.rlim_cur;
  setrlimit(resource, &limits);
}

/// Returns false if the reader has closed the pipe.
bool send(int to, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = write(to, bytes.data(), bytes.size());
    if (sent < 0 && errno != EINTR) return false;
    if (sent > 0) bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

/// Returns the bytes of memory that this process already owns. Limits of a child include these bytes.
double own_memory() {
  constexpr double untold = 1e15;  // without /proc, there is no such limit
  try {
    const std::string numbers = InputFile("/proc/self/statm").head(256);
    unsigned long data = 0;
    if (std::sscanf(numbers.c_str(), "%*u %*u %*u %*u %*u %lu", &data) == 1)
      return static_cast<double>(data) * static_cast<double>(sysconf(_SC_PAGESIZE));
  } catch (const InputError&) {
  }
  return untold;
}

/// Runs the child from start to end. No destructor and no handler of the parent runs in it.
[[noreturn]] void live_apart(int to, const std::function<std::string()>& work, double most_seconds,
                             double most_memory) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int number : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGXCPU, SIGPIPE, SIGTERM})
    std::signal(number, SIG_DFL);
  std::signal(SIGINT, SIG_IGN);  // the parent handles SIGINT and ends this process
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_CPU, std::ceil(most_seconds));
#ifndef TUBEFOOT_SANITIZED  // sanitizers reserve terabytes of address space and read files for their reports
  limit(RLIMIT_DATA, most_memory);
  limit(RLIMIT_NOFILE, 0);
#else
  static_cast<void>(most_memory);
#endif
  bool sent = false;
  try {
    const std::string bytes = work();
    sent = send(to, "+") && send(to, bytes);
  } catch (const std::bad_alloc&) {
    sent = send(to, "-") && send(to, "it needs more memory than its size explains, or than is available");
  } catch (const std::exception& error) {
    sent = send(to, "-") && send(to, error.what());
  } catch (const Interrupted&) {
  }
  _exit(sent ? 0 : 1);
}

class Child {
 public:
  explicit Child(pid_t id) : id_(id) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (id_ > 0) {
      kill(id_, SIGKILL);
      wait();
    }
  }
  int wait() {
    int status = 0;
    while (waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    id_ = 0;
    return status;
  }

 private:
  pid_t id_;
};

class End {
 public:
  explicit End(int descriptor) : descriptor_(descriptor) {}
  End(const End&) = delete;
  End& operator=(const End&) = delete;
  ~End() { close_now(); }
  void close_now() {
    if (descriptor_ >= 0) close(descriptor_);
    descriptor_ = -1;
  }
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

[[noreturn]] void fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

std::string all_from(int descriptor) {
  std::string bytes, piece(std::size_t{1} << 16, '\0');
  for (;;) {
    stop_if_wanted();
    pollfd waited{descriptor, POLLIN, 0};
    constexpr int wait_ms = 100;
    if (poll(&waited, 1, wait_ms) <= 0) continue;
    const ssize_t count = read(descriptor, piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return bytes;
    bytes.append(piece, 0, static_cast<std::size_t>(count));
  }
}

}  // namespace

ApartResult done_apart(const std::function<std::string()>& work, double most_seconds, double most_memory) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) fail("cannot create a pipe");
  const End from(ends[0]);
  End to(ends[1]);
  const double memory_in_all = own_memory() + most_memory;
  const pid_t id = fork();
  if (id < 0) fail("cannot start a process that reads the file");
  if (id == 0) live_apart(to.descriptor(), work, most_seconds, memory_in_all);
  Child child(id);
  to.close_now();
  std::string bytes = all_from(from.descriptor());
  const int status = child.wait();
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) return {ApartResult::End::too_long, {}};
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) return {ApartResult::End::too_long, {}};
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || bytes.empty()) return {};
  return {bytes.front() == '+' ? ApartResult::End::done : ApartResult::End::refused, bytes.substr(1)};
}

}  // namespace tubefoot
