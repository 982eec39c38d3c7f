// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

// A small file system of one process' own, to be filled up. For child processes only.
namespace tubefoot::full_disk {

inline bool try_mount(const std::filesystem::path& folder, std::size_t bytes) {
  const auto user = geteuid();
  if (unshare(user == 0 ? CLONE_NEWNS : CLONE_NEWNS | CLONE_NEWUSER) != 0) return false;
  if (user != 0) std::ofstream("/proc/self/uid_map") << "0 " << user << " 1";
  if (::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return false;
  return ::mount("tmpfs", folder.c_str(), "tmpfs", 0, fmt::format("size={}", bytes).c_str()) == 0;
}

/// Ends the process where that fails.
inline void mount(const std::filesystem::path& folder, std::size_t bytes) {
  if (try_mount(folder, bytes)) return;
  std::perror("no private file system");
  std::_Exit(3);
}

/// Whether mount() works here; asks a child process.
inline bool available() {
  const pid_t child = fork();
  if (child == 0) std::_Exit(try_mount(std::filesystem::temp_directory_path(), 1 << 20) ? 0 : 1);
  int status = 1;
  waitpid(child, &status, 0);
  return status == 0;
}

}  // namespace tubefoot::full_disk
