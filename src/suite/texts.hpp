// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace tubefoot {

// What lies beside the scenes in every pack, put into the program by embed.cmake.
extern const std::string_view readme, errata, checker, licence;

}  // namespace tubefoot
