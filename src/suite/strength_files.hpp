// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>

#include "suite/write_suite.hpp"

namespace tubefoot {

/// Writes a scene of target strength: body and scene.json into `place`. With `answers`, also a table of
/// certified Kirchhoff values and the published values of boundary elements, into that folder.
void write_strength_scene(const std::filesystem::path& place,
                          const std::optional<std::filesystem::path>& answers, const SuiteScene& scene,
                          WrittenSuiteScene& written);

}  // namespace tubefoot
