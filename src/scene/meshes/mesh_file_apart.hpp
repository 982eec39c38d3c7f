// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// What became of work in a process of its own.
struct ApartResult {
  enum class End { done, refused, crashed, too_long } end = End::crashed;
  std::string bytes;  ///< done: what the work returned; refused: what its exception says
};

/// Does work on what a stranger wrote with a library that may crash, hang or take all memory on it, in a
/// process of its own that can open no file and ends with this one. The work sees the memory of this process
/// as it is now. `most_seconds` of processor time, `most_memory` bytes
/// beyond what this process has. Throws std::system_error where no process can be started.
ApartResult done_apart(const std::function<std::string()>& work, double most_seconds, double most_memory);

}  // namespace tubefoot
