// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/advised_command.hpp"

#include <fmt/format.h>

#include <system_error>

namespace tubefoot {

namespace fs = std::filesystem;

std::string shell_word(const fs::path& file) {
  std::string text = file.string();
  if (text.starts_with('-')) text = "./" + text;  // so that it is not an option
  constexpr std::string_view plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-+=:@%,";
  if (!text.empty() && text.find_first_not_of(plain) == text.npos) return text;
  std::string quoted = "'";
  for (const char c : text)
    if (c == '\'')
      quoted += "'\\''";
    else
      quoted += c;
  return quoted + "'";
}

fs::path new_file_beside(const fs::path& file, std::string_view extension, int first) {
  for (int number = first;; ++number) {
    fs::path name = file;
    name.replace_filename(fmt::format("{}_new{}{}", file.stem().string(),
                                      number == 1 ? "" : std::to_string(number), extension));
    std::error_code error;
    if (!fs::exists(fs::symlink_status(name, error)) || number >= first + 1000) return name;
  }
}

std::string advised_command(std::string_view command, const fs::path& file, std::string_view extension) {
  return fmt::format("`{} {} {}`", command, shell_word(file), shell_word(new_file_beside(file, extension)));
}

std::string advised_ogr2ogr(std::string_view options, const fs::path& file) {
  return fmt::format("`ogr2ogr{}{} {} {}`", options.empty() ? "" : " ", options,
                     shell_word(new_file_beside(file, ".gpkg")), shell_word(file));
}

}  // namespace tubefoot
