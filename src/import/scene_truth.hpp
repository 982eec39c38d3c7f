// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "scene/description/scene_description.hpp"
#include "sensors/recordings/whole_echo_file.hpp"

namespace tubefoot {

/// What `run` makes of a sensor of a scene: its first `pings` pings, or all where it has no more. A file in
/// `folder` is written for it and taken away. Throws as `run`.
WholeEchoFile truth_of_scene(SceneDescription description, const std::optional<std::string>& sensor,
                             std::size_t pings, const std::filesystem::path& folder);

}  // namespace tubefoot
