// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace tubefoot {

/// Looks in the bytes of a file for words by which a coordinate reference system names files of corrections:
/// PROJ opens them, wherever they lie, as soon as GDAL meets them, and lets nobody in between.
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

}  // namespace tubefoot
