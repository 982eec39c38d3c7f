// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "viewer/view_data.hpp"

namespace tubefoot {

/// Returns one HTML page with markup, style, scripts (src/viewer/*.{html,css,js}) and data, which loads
/// nothing from the network. The resolution of positions is a millionth of the extent of the footprints.
/// Energies have a relative error below 1e-5. All data is compressed (packed_array.hpp).
std::string view_page(const ViewData& data);

}  // namespace tubefoot
