// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace tubefoot {

/// Looks in the bytes of a file for words by which a coordinate reference system names files of corrections.
/// It finds the plain spelling only, and says in which file it stands. ProjConfinement holds for every
/// spelling.
class GridWords {
 public:
  /// The next bytes, in pieces of any size.
  void feed(std::string_view piece);
  /// The first word that was met; empty: none.
  std::string_view met() const { return met_; }

 private:
  std::string tail_;  ///< in which a word may have begun
  std::string_view met_;
};

/// What to say of a file whose coordinate reference system names files: `named` is one, or the word for it.
std::string names_grids(std::string_view named);

}  // namespace tubefoot
