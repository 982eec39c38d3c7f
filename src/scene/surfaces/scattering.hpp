// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/scattering/scattering_model.hpp"

namespace tubefoot {

struct SceneDescription;

/// The scattering models of a scene by material; null where it is Lambert's, which needs no more than its mu.
/// Throws InputError for a table that cannot be read and for a law that scatters more than it receives from
/// some angle, unless the material is `unbounded`. Warns of sensors whose frequency a sediment's table is not
/// meant for, and of laws that are unbounded because they were allowed to be.
std::vector<std::shared_ptr<const ScatteringModel>> load_scattering(const SceneDescription& scene,
                                                                    std::vector<std::string>& warnings);

}  // namespace tubefoot
