// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

#include "files/shown.hpp"

// This header defines all output of the program to stdout and stderr. The functions apply harmless() to text
// from input files.
namespace tubefoot {

/// Prints to stderr. Ignores failures: a closed terminal or a full disk under the log must not end a run.
template <class... T>
void say(fmt::format_string<T...> format, T&&... parts) {
  const std::string text = harmless(fmt::format(format, std::forward<T>(parts)...));
  std::fwrite(text.data(), 1, text.size(), stderr);
}

/// errno of a failed tell(), or 0.
inline int tell_error = 0;

/// Prints the requested output of a command to stdout. Throws std::runtime_error on failure.
template <class... T>
void tell(fmt::format_string<T...> format, T&&... parts) {
  const std::string text = harmless(fmt::format(format, std::forward<T>(parts)...));
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) {
    tell_error = errno;
    throw std::runtime_error("cannot write to standard output");
  }
}

/// Draws on the terminal to which stderr writes. `parts` come from the program itself and may contain
/// control characters.
template <class... T>
void draw_on_terminal(fmt::format_string<T...> format, T&&... parts) {
  const std::string text = fmt::format(format, std::forward<T>(parts)...);
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace tubefoot
