// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/signal/smooth_surface.hpp"

namespace tubefoot {

struct SceneDescription;

/// Returns the smooth surfaces by material; empty for a rough material. It warns of smooth materials in
/// scenes whose sensors record no phases, because energies follow the scattering model. It also warns of
/// scatterers, which nothing reads there.
std::vector<std::optional<SmoothSurface>> load_smooth_surfaces(const SceneDescription& scene,
                                                               std::vector<std::string>& warnings);

}  // namespace tubefoot
