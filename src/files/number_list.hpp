// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Parses lists of numbers on the command line.
namespace tubefoot {

/// Returns the parts of a text between separators, at least one.
std::vector<std::string> split_at(const std::string& text, char at);

/// Parses a finite number that is the whole text; none otherwise.
std::optional<double> number_of(std::string_view text);

/// Format of a list: the option and the expected form for messages, the step of a range without one, and the
/// meaning of a word.
struct NumberList {
  std::string option;
  std::string expected = "FIRST:LAST:STEP or numbers separated by commas";
  std::optional<double> step{};
  std::function<std::optional<double>(std::string_view)> read = number_of;
};

/// Parses "FIRST:LAST:STEP" (with LAST if a step meets it), "FIRST:LAST" with the step of `list`, or numbers
/// separated by commas. The result is increasing and has at most a million values. Throws UsageError, which
/// names the option.
std::vector<double> numbers_of(const std::string& text, const NumberList& list);

}  // namespace tubefoot
