// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

// Functions for messages about input: the most similar name, and lists of names.
namespace tubefoot {

/// Returns the edit distance, with a swap of neighbours as one step (optimal string alignment distance).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// Returns the candidate with the least edit distance to `word`, or an empty text if none is similar
/// enough.
std::string_view nearest(std::string_view word, const std::vector<std::string>& candidates);

/// Returns 'a', 'b' or 'c' (with the given quotation mark).
std::string one_of(const std::vector<std::string>& words, char quote);

}  // namespace tubefoot
