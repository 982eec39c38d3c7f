// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/scattering/scattering_model.hpp"

namespace tubefoot {

struct SceneDescription;

/// Returns the scattering models of a scene by material; null for Lambert's law, which needs only its mu.
/// Throws InputError for a table that cannot be read. A model that scatters more than it receives at some
/// angle is an error, too, unless the material is `unbounded`. Adds warnings for sensors whose frequency is
/// outside of a sediment's table, and for models that are unbounded by permission.
std::vector<std::shared_ptr<const ScatteringModel>> load_scattering(const SceneDescription& scene,
                                                                    std::vector<std::string>& warnings);

}  // namespace tubefoot
