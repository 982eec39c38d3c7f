// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "exchange/exchanged_scene.hpp"

namespace tubefoot {

class Sensor;

/// Returns all properties of a sonar except its placement.
ExchangedSonar sonar_words(const Sensor& sensor);

/// Returns the value of a key as TOML: a number, a list of numbers separated by spaces, or a word of
/// letters and _. Other texts, and texts longer than any valid value, give an empty result.
std::string toml_value(std::string_view text);
/// Returns whether a text is a valid name of a key: lower-case letters and _.
bool is_key(std::string_view text);

}  // namespace tubefoot
