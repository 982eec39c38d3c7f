// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/description/material_description.hpp"
#include "scene/file/toml_reader.hpp"

// The keys of a material that say how it scatters, and what of it is smooth.
namespace tubefoot {

std::vector<TomlField<MaterialDescription>> scattering_fields();

/// Which keys go with which law.
void check_scattering(const MaterialDescription& material, const TomlTable& table);

std::vector<TomlField<MaterialDescription>> smooth_fields();

/// Keys of smooth materials are theirs alone, and one of them says what is reflected.
void check_smooth(const MaterialDescription& material, const TomlTable& table);

}  // namespace tubefoot
