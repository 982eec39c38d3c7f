// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/scattering/reflectivity_field.hpp"
#include "scene/description/material_description.hpp"
#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// The micro-texture of a material, null for none. Layers multiply; noise in layer k is that of its seed and
/// of k, so that no two layers are alike. Throws InputError for a second map, with the raster's file name for
/// one that cannot be read or placed: no georeference in a scene that is georeferenced, or the other way
/// round; a CRS in which it is no parallelogram in the frame to within half a pixel.
std::shared_ptr<const ReflectivityField> load_reflectivity(const MaterialDescription& material,
                                                           const LocalFrame& frame,
                                                           std::vector<std::string>& warnings);

}  // namespace tubefoot
