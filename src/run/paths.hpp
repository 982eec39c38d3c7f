// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "engine/paths/path_echo.hpp"
#include "run/fleet.hpp"
#include "scene/scene.hpp"

// Paths of a run besides the straight one to a facet and back (docs/paths.md, docs/bistatic.md).
namespace tubefoot {

/// What has to be followed besides the ordinary echo: nothing in a scene without mirrors.
std::optional<PathSettings> path_settings(const Scene& scene, double frequency_khz);

/// A material with facets that are mirrors and not level, if there is one.
std::optional<std::size_t> material_of_inclined_mirrors(const Scene& scene);

/// Throws InputError for paths that the scene cannot have: several orders without a mirror, sensors above the
/// sea.
void check_paths(const Scene& scene, const Fleet& fleet);

}  // namespace tubefoot
