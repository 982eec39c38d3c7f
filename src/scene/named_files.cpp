// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/named_files.hpp"

#include <algorithm>
#include <string>

#include "scene/vrt_sources.hpp"

namespace tubefoot {

namespace fs = std::filesystem;

std::vector<fs::path> companions_of(const fs::path& file) {
  std::vector<fs::path> found;
  const auto add = [&found](const fs::path& path) {
    std::error_code ignored;
    if (fs::is_regular_file(path, ignored)) found.push_back(path);
  };
  for (const char* instead : {".dbf", ".shx", ".cpg", ".prj", ".tfw", ".wld", ".tab"}) {
    std::string upper = instead;
    std::ranges::transform(upper, upper.begin(), [](char c) { return c >= 'a' && c <= 'z' ? c - 32 : c; });
    for (const std::string& extension : {std::string(instead), upper})
      if (extension != file.extension()) add(fs::path(file).replace_extension(extension));
  }
  for (const char* after : {".aux.xml", ".msk", "-wal"}) add(fs::path(file) += after);
  for (const fs::path& source : vrt_sources(file)) {
    add(source);
    for (const char* after : {".aux.xml", ".msk"}) add(fs::path(source) += after);
  }
  return found;
}

std::optional<fs::path> place_outside(const fs::path& folder, const fs::path& file) {
  std::error_code error;
  const fs::path inside = fs::weakly_canonical(fs::absolute(folder.empty() ? "." : folder), error);
  const fs::path real = fs::weakly_canonical(fs::absolute(file), error);
  if (std::ranges::mismatch(inside, real).in1 == inside.end()) return std::nullopt;
  return real;
}

}  // namespace tubefoot
