// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/scattering/volume_scattering.hpp"
#include "scene/description/water_description.hpp"

namespace tubefoot {

/// Returns the volume scattering of the described water, with heights in the local frame. A table has one row
/// per layer; each layer ends at the depth of the next row. The water above the first row does not scatter,
/// and the last layer continues below its row. `surface_height_m` is the height of the sea surface. If
/// `ends_at_surface`, nothing scatters above it. Throws InputError at the line and column of the file.
VolumeScattering load_volume_scattering(const WaterDescription& water, double surface_height_m,
                                        bool ends_at_surface);

/// Returns a warning if the table of layers ends above the lowest point of the scene.
std::optional<std::string> short_layers_warning(const WaterDescription& water, const VolumeScattering& volume,
                                                double surface_height_m, double lowest_m);

}  // namespace tubefoot
