// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace tubefoot {

// Page, style and scripts of the viewer, which embed.cmake compiles into the program.
extern const std::string_view page_html, page_css, page_js;

}  // namespace tubefoot
