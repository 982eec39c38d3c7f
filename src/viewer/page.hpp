// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "viewer/view_data.hpp"

namespace tubefoot {

/// One HTML page that holds everything: markup, style, scripts (src/viewer/*.{html,css,js}) and the data.
/// It asks the network for nothing. Places are kept in millionths of the footprints' extent, energies to
/// within 1e-5 of each, all of it compressed (packed_array.hpp).
std::string view_page(const ViewData& data);

}  // namespace tubefoot
