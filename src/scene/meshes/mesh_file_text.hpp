// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "files/input_error.hpp"

namespace tubefoot {

/// Walks through a text mesh file line by line and word by word; errors carry file, line and column. Lines
/// end as the first one does: in a line feed, or in a carriage return alone.
class TextLines {
 public:
  /// `joined`: a backslash at the end of a line continues it (OBJ).
  TextLines(std::string_view content, std::string file, bool joined = false);

  /// Goes to the next line; false at the end of the file.
  bool next();
  /// Goes to the next line that has a word outside of # comments. Throws InputError naming `expected` at the
  /// end.
  void next_with_words(std::string_view expected);

  /// The next word of the line; empty at its end.
  std::string_view word();
  /// The next word as a finite number. Throws InputError that names `what`.
  double number(std::string_view what);
  /// The next word, which there must be, whatever it is. Throws InputError that names `what`.
  void skip(std::string_view what);
  /// The next word as an integer. Throws InputError that names `what`.
  std::int64_t integer(std::string_view what);
  std::int64_t parse_integer(std::string_view text, std::string_view what) const;

  int line() const { return line_; }
  /// Where the last word began.
  SourcePlace place() const { return {file_, line_, column_}; }
  /// What follows the current line.
  std::string_view rest() const { return content_.substr(next_); }

 private:
  std::string_view content_;
  std::string file_;
  bool joined_;
  char line_end_ = '\n';
  std::size_t begin_ = 0, at_ = 0, end_ = 0,
              next_ = 0;  // of the line: begin, place of reading, end, next line
  int line_ = 0, line_count_ = 1, column_ = 0;
};

}  // namespace tubefoot
