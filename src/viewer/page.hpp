// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "viewer/view_data.hpp"

namespace tubefoot {

/// One HTML page that holds everything: markup, style, scripts (src/viewer/*.{html,css,js}) and the data.
/// It asks the network for nothing. Numbers are kept in single precision: places about the middle of the
/// footprints, energies over the largest one.
std::string view_page(const ViewData& data);

}  // namespace tubefoot
