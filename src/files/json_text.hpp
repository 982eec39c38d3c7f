// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace tubefoot {

/// As it is written to files. Names of files may be of any bytes: what is no UTF-8 in them becomes U+FFFD.
inline std::string text_of(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

/// A name of a file as text, the same way.
inline std::string text_of_name(const std::string& name) {
  return nlohmann::ordered_json::parse(text_of(name)).get<std::string>();
}

}  // namespace tubefoot
