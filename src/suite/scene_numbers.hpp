// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "run/survey.hpp"
#include "suite/suite_scene.hpp"

namespace tubefoot {

/// All that an engine has to know of a scene, in numbers: scene.json of the pack (its README lists the keys).
nlohmann::ordered_json scene_numbers(const Aspect& aspect, const SuiteScene& scene, const Survey& survey);

}  // namespace tubefoot
