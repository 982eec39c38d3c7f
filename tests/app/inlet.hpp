// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#include "app/program.hpp"

// What the program opens and whom it calls, seen from outside.
namespace tubefoot {

/// A host that waits for a call.
class Listener {
 public:
  Listener() : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (bind(socket_, reinterpret_cast<sockaddr*>(&address), size) != 0 || listen(socket_, 8) != 0 ||
        getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
      throw std::runtime_error("no socket");
    port_ = ntohs(address.sin_port);
  }
  ~Listener() { close(socket_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  std::string address() const { return fmt::format("http://127.0.0.1:{}", port_); }
  /// Whether anybody has tried to connect.
  bool was_called() const {
    pollfd waiting{socket_, POLLIN, 0};
    return poll(&waiting, 1, 0) > 0;
  }

 private:
  int socket_;
  int port_ = 0;
};

/// What the program opened that belongs to no system, library or program.
struct OpenedFiles {
  std::set<std::string> read, written;
};

struct WatchedRun {
  Outcome outcome;
  OpenedFiles opened;
};

inline WatchedRun run_watched(const std::vector<std::string>& words, Surroundings surroundings = {}) {
  const TestFolder notes;
  surroundings.before = {"/usr/bin/env", std::string("LD_PRELOAD=") + TUBEFOOT_OPENED_FILES,
                         "TUBEFOOT_OPENED=" + (notes / "opened").string()};
  WatchedRun run{run_program(words, surroundings), {}};
  std::istringstream lines(bytes_of(notes / "opened"));
  const std::string build = std::filesystem::path(TUBEFOOT_PROGRAM).parent_path().string() + "/";
  for (std::string line; std::getline(lines, line);) {
    const std::string name = line.substr(2);
    const auto in = [&name](const std::string& folder) { return name.starts_with(folder); };
    if (in("/usr/") || in("/lib") || in("/etc/") || in("/proc/") || in("/sys/") || in("/dev/") || in(build) ||
        in("pipe:") || in("/var/cache/fontconfig"))
      continue;
    (line[0] == 'r' ? run.opened.read : run.opened.written).insert(name);
  }
  return run;
}

}  // namespace tubefoot
