// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "exchange/frames.hpp"

// Parts of scene files that importer and exporter write.
namespace tubefoot {

/// Returns a text as a string of TOML, with its quotes. Control characters are escaped.
std::string toml_quoted(const std::string& text);
/// Returns a list of numbers, broken into lines of a few numbers as scene files require.
std::string toml_list(const std::vector<std::string>& numbers);
std::string toml_list(const std::vector<double>& numbers);
/// Returns the keys of a position and an attitude: `position_m`, and each angle that is not 0.
std::string place_keys(const Placement& placed);

}  // namespace tubefoot
