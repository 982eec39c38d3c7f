// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/console/written.hpp"

#include <fmt/format.h>

#include <cctype>
#include <map>

namespace tubefoot {

namespace {

constexpr std::size_t told_one_by_one = 2;

/// Returns the name without its last number of two or more digits, or the name itself if it has no such
/// number.
std::string without_number(const std::string& name) {
  const auto digit = [](unsigned char c) { return std::isdigit(c) != 0; };
  auto end = name.size();
  while (end > 0) {
    while (end > 0 && !digit(static_cast<unsigned char>(name[end - 1]))) --end;
    auto begin = end;
    while (begin > 0 && digit(static_cast<unsigned char>(name[begin - 1]))) --begin;
    if (end - begin >= 2) return name.substr(0, begin) + '\n' + name.substr(end);
    end = begin;
  }
  return name;
}

}  // namespace

std::vector<std::string> written_lines(const std::filesystem::path& folder,
                                       const std::vector<std::filesystem::path>& files) {
  std::map<std::string, std::vector<std::string>> alike;
  for (const auto& file : files) alike[without_number(file.string())].push_back(file.string());
  std::vector<std::string> lines;
  for (const auto& file : files) {
    const std::vector<std::string>& group = alike.at(without_number(file.string()));
    const std::string path = (folder / file).string();
    if (group.size() <= told_one_by_one)
      lines.push_back("wrote " + path);
    else if (group.front() == file.string())
      lines.push_back(fmt::format("wrote {} to {} ({} files)", path, group.back(), group.size()));
  }
  return lines;
}

}  // namespace tubefoot
