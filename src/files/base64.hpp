// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace tubefoot {

/// Bytes as text, for what a page or a drawing holds within itself (RFC 4648).
std::string base64(std::string_view bytes);

}  // namespace tubefoot
