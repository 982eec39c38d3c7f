// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

#include "scene/file/toml_reader.hpp"

namespace tubefoot {

/// Parses a TOML text. Throws InputError at the line of a syntax error, with a hint at the probable
/// meaning. Keys that are nested too deeply for the parser's stack are an error as well.
toml::table parse_toml(std::string_view text, const TomlSource& source);

}  // namespace tubefoot
