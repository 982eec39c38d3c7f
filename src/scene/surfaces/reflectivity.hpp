// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/scattering/reflectivity_field.hpp"
#include "scene/description/material_description.hpp"
#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// Returns the micro-texture of a material, or null. Layers multiply. The noise in layer k depends on its
/// seed and on k, so that all layers differ.
/// Throws InputError for a second map, and with the raster's file name for a map that cannot be read or
/// placed. Map and scene must both have a georeference, or neither. The map must be a parallelogram in the
/// frame to within half a pixel.
std::shared_ptr<const ReflectivityField> load_reflectivity(const MaterialDescription& material,
                                                           const LocalFrame& frame,
                                                           std::vector<std::string>& warnings);

}  // namespace tubefoot
