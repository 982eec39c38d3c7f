// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "scene/description/scene_description.hpp"
#include "sensors/recordings/whole_echo_file.hpp"

namespace tubefoot {

/// Computes the result of `run` for a sensor of a scene: its first `pings` pings, or all if it has fewer.
/// Writes a temporary file in `folder`. Throws under the same conditions as `run`.
WholeEchoFile truth_of_scene(SceneDescription description, const std::optional<std::string>& sensor,
                             std::size_t pings, const std::filesystem::path& folder);

}  // namespace tubefoot
