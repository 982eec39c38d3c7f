// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/description/material_description.hpp"
#include "scene/file/toml_reader.hpp"

// Keys of a material for its scattering model and its smooth surface.
namespace tubefoot {

std::vector<TomlField<MaterialDescription>> scattering_fields();

/// Checks which keys the chosen scattering model permits and requires.
void check_scattering(const MaterialDescription& material, const TomlTable& table);

std::vector<TomlField<MaterialDescription>> smooth_fields();

/// Checks that only smooth materials have the keys of smooth materials, and that one of these keys states
/// the reflection.
void check_smooth(const MaterialDescription& material, const TomlTable& table);

}  // namespace tubefoot
