// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

#include "files/shown.hpp"

// All that the program says. What comes from input is made harmless() here, once for all.
namespace tubefoot {

/// Prints to stderr. What cannot be told is left untold: no run ends because its terminal was closed, or
/// because the disk under its log is full.
template <class... T>
void say(fmt::format_string<T...> format, T&&... parts) {
  const std::string text = harmless(fmt::format(format, std::forward<T>(parts)...));
  std::fwrite(text.data(), 1, text.size(), stderr);
}

/// errno of what tell() could not print; 0: it could.
inline int tell_error = 0;

/// Prints to stdout what a command was asked for. Throws std::runtime_error if it cannot.
template <class... T>
void tell(fmt::format_string<T...> format, T&&... parts) {
  const std::string text = harmless(fmt::format(format, std::forward<T>(parts)...));
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) {
    tell_error = errno;
    throw std::runtime_error("cannot write to standard output");
  }
}

/// Draws on the terminal that stderr is: `parts` are our own, control characters and all.
template <class... T>
void draw_on_terminal(fmt::format_string<T...> format, T&&... parts) {
  const std::string text = fmt::format(format, std::forward<T>(parts)...);
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace tubefoot
