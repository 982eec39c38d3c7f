// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/relief/elevation_field.hpp"
#include "scene/description/material_description.hpp"
#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// Returns the relief of every material: the sum of its entries, or null without entries. Equal entries of
/// several materials are computed once. Throws InputError at the entry for a tile with too many nodes, and
/// for a map that cannot be read or placed. Ripples that the tile cannot contain or resolve are an error,
/// too.
std::vector<std::shared_ptr<const ElevationField>> load_relief(
    const std::vector<MaterialDescription>& materials, const LocalFrame& frame,
    std::vector<std::string>& warnings);

}  // namespace tubefoot
