// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/input_error.hpp"

#include <fmt/format.h>

namespace tubefoot {

std::string to_string(const SourcePlace& place) {
  if (place.line <= 0) return place.file;
  if (place.column <= 0) return fmt::format("{}:{}", place.file, place.line);
  return fmt::format("{}:{}:{}", place.file, place.line, place.column);
}

}  // namespace tubefoot
