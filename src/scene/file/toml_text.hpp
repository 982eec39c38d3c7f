// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

#include "scene/file/toml_reader.hpp"

namespace tubefoot {

/// A TOML text as a table. Throws InputError at its line for what is no TOML, saying what may be meant, and
/// for keys nested so deep that the parser's stack would not hold them.
toml::table parse_toml(std::string_view text, const TomlSource& source);

}  // namespace tubefoot
