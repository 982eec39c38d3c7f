// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace tubefoot {

/// Encodes bytes as base64 (RFC 4648), for data that is embedded in a page or a drawing.
std::string base64(std::string_view bytes);

}  // namespace tubefoot
