// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <utility>

namespace tubefoot {

/// Prints to stderr. What cannot be told is left untold: no run ends because its terminal was closed, or
/// because the disk under its log is full.
template <class... T>
void say(fmt::format_string<T...> format, T&&... parts) {
  const std::string text = fmt::format(format, std::forward<T>(parts)...);
  std::fwrite(text.data(), 1, text.size(), stderr);
}

}  // namespace tubefoot
