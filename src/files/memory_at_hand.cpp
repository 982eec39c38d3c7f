// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/memory_at_hand.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <new>

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Returns the minimum of the memory limits of the process's control group and of its parents. The group is
/// of version 2, or of version 1 with its own tree for memory. Without limits the result is infinite.
double control_group_limit() {
  double least = std::numeric_limits<double>::infinity();
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {  // "number:controllers:/group"
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == line.npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const bool of_all = controllers == ",,";
    if (!of_all && controllers.find(",memory,") == controllers.npos) continue;
    const fs::path root = of_all ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory";
    for (fs::path group = fs::path(line.substr(second + 2)).lexically_normal();;
         group = group.parent_path()) {
      std::ifstream file(root / group / (of_all ? "memory.max" : "memory.limit_in_bytes"));
      if (double bytes = 0; file >> bytes) least = std::min(least, bytes);  // "max" is not a number
      if (group.empty() || group == group.parent_path()) break;
    }
  }
  return least;
}

}  // namespace

double memory_at_hand() {
  const double page = static_cast<double>(sysconf(_SC_PAGESIZE));
  double address_pages = 0, resident_pages = 0;
  std::ifstream("/proc/self/statm") >> address_pages >> resident_pages;
  const double machine = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * page;
  double at_hand = std::min(machine, control_group_limit()) - resident_pages * page;
  if (rlimit limit{}; getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
    at_hand = std::min(at_hand, static_cast<double>(limit.rlim_cur) - address_pages * page);
  return std::max(at_hand, 0.0);
}

void require_addresses(std::size_t bytes) {
  void* const room = mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED) throw std::bad_alloc();
  munmap(room, bytes);
}

void require_memory(double bytes, const SourcePlace& place, const std::string& what,
                    const std::string& remedy) {
  const double at_hand = memory_at_hand();
  if (bytes <= at_hand) return;
  throw InputError(
      place, fmt::format("{} would need {:.3g} GB of memory, but only {:.3g} GB are available: {}", what,
                         bytes / 1e9, at_hand / 1e9, remedy));
}

}  // namespace tubefoot
