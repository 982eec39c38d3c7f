// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "advice/advice.hpp"
#include "scene/description/scene_description.hpp"

namespace tubefoot {

/// Returns the output of `tubefoot advise --json` for a scene (docs/accuracy-and-speed.md).
nlohmann::ordered_json json_of(const Advice& advice, const SceneDescription& scene);

}  // namespace tubefoot
