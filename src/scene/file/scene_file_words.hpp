// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

// The words of scene-file messages: units that key names end in, near misses of a word, lists.
namespace tubefoot {

/// A key's name, cut into what it measures and the unit it ends in: "heading_deg" is "heading" in "degrees".
struct MeasuredName {
  std::string_view stem;  ///< the whole name where it ends in no unit
  std::string_view unit;  ///< in words; empty where it ends in no unit
};
MeasuredName measured_name(std::string_view key);

/// Edit distance with neighbours swapped as one step (optimal string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate with the least edit distance to `word`, or an empty text when none is near enough to be
/// meant.
std::string_view nearest(std::string_view word, const std::vector<std::string>& candidates);

/// 'a', 'b' or 'c' (with the quote mark that is given).
std::string one_of(const std::vector<std::string>& words, char quote);

}  // namespace tubefoot
