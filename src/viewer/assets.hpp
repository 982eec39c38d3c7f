// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace tubefoot {

// The viewer's page, style and scripts, put into the program by embed.cmake.
extern const std::string_view page_html, page_css, page_js;

}  // namespace tubefoot
