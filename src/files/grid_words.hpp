// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace tubefoot {

/// Searches the bytes of a file for keywords by which a coordinate reference system names files of
/// corrections. It finds only the plain spelling, and the message can then name the file. ProjConfinement
/// blocks all spellings.
class GridWords {
 public:
  /// Takes the next bytes, in pieces of any size.
  void feed(std::string_view piece);
  /// Returns the first keyword found; empty if there is none.
  std::string_view met() const { return met_; }

 private:
  std::string tail_;  ///< last bytes, in which a keyword may have begun
  std::string_view met_;
};

/// Returns the message for a file whose coordinate reference system names files. `named` is such a file or
/// the keyword.
std::string names_grids(std::string_view named);

}  // namespace tubefoot
