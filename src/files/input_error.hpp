// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace tubefoot {

/// A place in an input file. Line and column count from 1. 0 means unknown, in a binary file or for the
/// whole file.
struct SourcePlace {
  std::string file;
  int line = 0, column = 0;
};

/// Returns "scene.toml:12:5", as far as the place is known.
std::string to_string(const SourcePlace& place);

/// An error in the input. The program exits with 2 and prints "place: what was expected, what to do".
struct InputError : std::runtime_error {
  /// The message passes through shown(), which escapes control characters.
  InputError(const SourcePlace& where, const std::string& message);
  SourcePlace place;
};

}  // namespace tubefoot
