// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "files/input_error.hpp"

namespace tubefoot {

/// Reads a text mesh file line by line and word by word. Errors contain file, line and column. All lines
/// end as the first does: with a line feed, or with a carriage return alone.
class TextLines {
 public:
  /// `joined` means that a backslash at the end of a line continues it (OBJ).
  TextLines(std::string_view content, std::string file, bool joined = false);

  /// Moves to the next line. Returns false at the end of the file.
  bool next();
  /// Moves to the next line that has a word outside of # comments. At the end of the file it throws
  /// InputError that names `expected`.
  void next_with_words(std::string_view expected);

  /// Returns the next word of the line; empty at its end.
  std::string_view word();
  /// Returns the next word as a finite number. Throws InputError that names `what`.
  double number(std::string_view what);
  /// Skips the next word, which must exist but may be any. Throws InputError that names `what`.
  void skip(std::string_view what);
  /// Returns the next word as an integer. Throws InputError that names `what`.
  std::int64_t integer(std::string_view what);
  std::int64_t parse_integer(std::string_view text, std::string_view what) const;

  int line() const { return line_; }
  /// Returns the place where the last word began.
  SourcePlace place() const { return {file_, line_, column_}; }
  /// Returns the text after the current line.
  std::string_view rest() const { return content_.substr(next_); }

 private:
  std::string_view content_;
  std::string file_;
  bool joined_;
  char line_end_ = '\n';
  std::size_t begin_ = 0, at_ = 0, end_ = 0,
              next_ = 0;  // of the line: begin, reading position, end, next line
  int line_ = 0, line_count_ = 1, column_ = 0;
};

}  // namespace tubefoot
