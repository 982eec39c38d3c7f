// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace tubefoot {

/// Returns the text of a JSON value for files. Names of files may have any bytes; bytes that are not UTF-8
/// become U+FFFD.
inline std::string text_of(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

/// Returns a file name as text, with the same replacement.
inline std::string text_of_name(const std::string& name) {
  return nlohmann::ordered_json::parse(text_of(name)).get<std::string>();
}

}  // namespace tubefoot
