// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/description/scene_description.hpp"
#include "scene/file/toml_reader.hpp"

// The keys of a material that say how it scatters.
namespace tubefoot {

std::vector<TomlField<MaterialDescription>> scattering_fields();

/// Which keys go with which law.
void check_scattering(const MaterialDescription& material, const TomlTable& table);

}  // namespace tubefoot
