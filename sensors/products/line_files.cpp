// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/products/line_files.hpp"

#include <fmt/format.h>

namespace tubefoot {

std::vector<std::string> line_names(const Recording& recording) {
  const std::string& name = recording.sensor->description().name;
  const std::size_t lines = recording.lines().size();
  if (lines == 1) return {name};
  std::vector<std::string> names;
  for (std::size_t k = 0; k < lines; ++k)
    names.push_back(fmt::format("{}-line-{:02}", name, recording.first_line + k + 1));
  return names;
}

}  // namespace tubefoot
