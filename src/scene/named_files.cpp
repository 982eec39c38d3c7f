// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/named_files.hpp"

#include <algorithm>
#include <initializer_list>
#include <string>

#include "scene/vrt_sources.hpp"

namespace tubefoot {

namespace fs = std::filesystem;

namespace {

/// With each of the extensions, in small and in capital letters, in place of the file's own, then with each
/// of the other ones after its whole name.
std::vector<fs::path> names_beside(const fs::path& file, std::initializer_list<const char*> instead,
                                   std::initializer_list<const char*> after) {
  std::vector<fs::path> names;
  for (const char* small : instead) {
    std::string upper = small;
    std::ranges::transform(upper, upper.begin(), [](char c) { return c >= 'a' && c <= 'z' ? c - 32 : c; });
    for (const std::string& extension : {std::string(small), upper})
      if (extension != file.extension()) names.push_back(fs::path(file).replace_extension(extension));
  }
  for (const char* extension : after) names.push_back(fs::path(file) += extension);
  return names;
}

}  // namespace

std::vector<fs::path> companions_of(const fs::path& file) {
  std::vector<fs::path> found = names_beside(file, {".dbf", ".shx", ".cpg", ".prj", ".tfw", ".wld", ".tab"},
                                             {".aux.xml", ".msk", "-wal"});
  for (const fs::path& source : vrt_sources(file)) {
    found.push_back(source);
    const std::vector<fs::path> beside = names_beside(source, {}, {".aux.xml", ".msk"});
    found.insert(found.end(), beside.begin(), beside.end());
  }
  std::erase_if(found, [](const fs::path& path) {
    std::error_code ignored;
    return !fs::is_regular_file(path, ignored);
  });
  return found;
}

std::optional<fs::path> special_companion(const fs::path& file) {
  for (const fs::path& path :
       names_beside(file,
                    {".dbf", ".shx", ".cpg", ".prj", ".tfw", ".wld", ".tab", ".aux", ".rrd", ".sbn", ".qix",
                     ".imd", ".rpb", ".clr"},
                    {".aux.xml", ".msk", ".ovr", ".msk.ovr", ".aux", "-wal", "-journal", "-shm"})) {
    std::error_code ignored;
    if (fs::is_other(path, ignored)) return path;
  }
  return std::nullopt;
}

std::optional<fs::path> place_outside(const fs::path& folder, const fs::path& file) {
  std::error_code error;
  const fs::path inside = fs::weakly_canonical(fs::absolute(folder.empty() ? "." : folder), error);
  const fs::path real = fs::weakly_canonical(fs::absolute(file), error);
  if (std::ranges::mismatch(inside, real).in1 == inside.end()) return std::nullopt;
  return real;
}

}  // namespace tubefoot
