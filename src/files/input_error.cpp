// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/input_error.hpp"

#include <fmt/format.h>

#include "files/shown.hpp"

namespace tubefoot {

std::string to_string(const SourcePlace& place) {
  if (place.line <= 0) return place.file;
  if (place.column <= 0) return fmt::format("{}:{}", place.file, place.line);
  return fmt::format("{}:{}:{}", place.file, place.line, place.column);
}

InputError::InputError(const SourcePlace& where, const std::string& message)
    : std::runtime_error(shown(to_string(where) + ": " + message)), place(where) {}

}  // namespace tubefoot
