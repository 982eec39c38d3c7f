// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "exchange/exchanged_scene.hpp"

namespace tubefoot {

class Sensor;

/// All of a sonar but where it is.
ExchangedSonar sonar_words(const Sensor& sensor);

/// A key's value as TOML: a number, a list of numbers between spaces, or a word of letters and _; empty for
/// what is none of them, and for what is longer than any of ours.
std::string toml_value(std::string_view text);
/// Whether a text is the name of a key: small letters and _.
bool is_key(std::string_view text);

}  // namespace tubefoot
