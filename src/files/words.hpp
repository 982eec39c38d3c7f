// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

// Words of messages about input: near misses of a name, lists of names.
namespace tubefoot {

/// Edit distance with neighbours swapped as one step (optimal string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate with the least edit distance to `word`, or an empty text when none is near enough to be
/// meant.
std::string_view nearest(std::string_view word, const std::vector<std::string>& candidates);

/// 'a', 'b' or 'c' (with the quote mark that is given).
std::string one_of(const std::vector<std::string>& words, char quote);

}  // namespace tubefoot
