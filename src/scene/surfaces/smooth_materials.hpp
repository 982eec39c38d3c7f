// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/signal/smooth_surface.hpp"

namespace tubefoot {

struct SceneDescription;

/// What smooth materials reflect, by material; none where it is rough. Warns of smooth materials in scenes
/// without a sensor that receives phases: energies go by the scattering model; and of scatterers, which
/// nothing reads there.
std::vector<std::optional<SmoothSurface>> load_smooth_surfaces(const SceneDescription& scene,
                                                               std::vector<std::string>& warnings);

}  // namespace tubefoot
