// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace tubefoot {

// Files in every pack in addition to the scenes. embed.cmake embeds them in the program.
extern const std::string_view readme, errata, checker, licence;

}  // namespace tubefoot
