// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// Result of work in a separate process.
struct ApartResult {
  enum class End { done, refused, crashed, too_long } end = End::crashed;
  std::string bytes;  ///< done: the result of the work; refused: the text of its exception
};

/// Runs work on untrusted data in a separate process, for a library that may crash, hang or take all
/// memory. The process cannot open files and ends with this one. The work sees the present memory of this
/// process.
/// `most_seconds` limits processor time, and `most_memory` limits the bytes in addition to those of this
/// process. Throws std::system_error if no process can be started.
ApartResult done_apart(const std::function<std::string()>& work, double most_seconds, double most_memory);

}  // namespace tubefoot
