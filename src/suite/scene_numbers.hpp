// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "run/survey.hpp"
#include "suite/suite_scene.hpp"

namespace tubefoot {

/// Returns all numbers of a scene that an engine needs: scene.json of the suite, whose README lists the
/// keys.
nlohmann::ordered_json scene_numbers(const Aspect& aspect, const SuiteScene& scene, const Survey& survey);

}  // namespace tubefoot
