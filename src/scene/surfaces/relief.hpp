// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/relief/elevation_field.hpp"
#include "scene/description/material_description.hpp"
#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// The relief of every material: the sum of its entries, null where it has none. What several materials say
/// alike is made once. Throws InputError at the entry: a tile of too many nodes, ripples that the tile cannot
/// hold or show, a map that cannot be read or placed.
std::vector<std::shared_ptr<const ElevationField>> load_relief(
    const std::vector<MaterialDescription>& materials, const LocalFrame& frame,
    std::vector<std::string>& warnings);

}  // namespace tubefoot
