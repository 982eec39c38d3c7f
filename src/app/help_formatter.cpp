// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/help_formatter.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

namespace tubefoot {
namespace {

constexpr std::size_t widest_line = 100, description_column = 28;

/// The choices of an option, else its option_text(), else "N" for numbers; empty for a flag. CLI11 writes
/// choices into the type's name: "TEXT:{tube,ray}".
std::string placeholder_of(const CLI::Option& option) {
  if (option.get_items_expected_max() == 0) return {};
  if (!option.get_option_text().empty()) return option.get_option_text();
  const std::string type = option.get_type_name();
  if (const std::size_t open = type.find('{'), close = type.find('}'); close != std::string::npos) {
    std::string choices = type.substr(open + 1, close - open - 1);
    std::ranges::replace(choices, ',', '|');
    return choices;
  }
  return type.starts_with("TEXT") ? "TEXT" : "N";
}

}  // namespace

std::string HelpFormatter::make_option(const CLI::Option* option, bool is_positional) const {
  std::string line = "  " + make_option_name(option, is_positional);
  if (const std::string placeholder = placeholder_of(*option); !is_positional && !placeholder.empty())
    line += " " + placeholder;
  if (is_positional && option->get_items_expected_max() > 1) line += " ...";
  if (option->get_required() && !is_positional) line += " (required)";
  std::string help;
  const auto next_line = [&] {
    help += line + "\n";
    line.assign(description_column, ' ');
  };
  if (line.size() + 2 > description_column)
    next_line();
  else
    line.resize(description_column, ' ');
  std::istringstream words(make_option_desc(option));
  bool begins = true;
  for (std::string word; words >> word; begins = false) {
    if (!begins && line.size() + 1 + word.size() > widest_line) {
      next_line();
      begins = true;
    }
    line += (begins ? "" : " ") + word;
  }
  return help + line + "\n";
}

std::string HelpFormatter::make_group(std::string group, bool is_positional,
                                      std::vector<const CLI::Option*> options) const {
  const bool is_first = is_positional || group == "Options";
  std::string text = CLI::Formatter::make_group(std::move(group), is_positional, std::move(options));
  if (!is_first && text.starts_with('\n')) text.erase(0, 1);
  return text;
}

}  // namespace tubefoot
