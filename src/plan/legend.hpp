// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec2.hpp>
#include <string>

#include "plan/marks.hpp"
#include "plan/sheet.hpp"

namespace tubefoot {

/// Draws the legend: sensors with their range gates, heights of the seabed, and the marks that the scene
/// contains. Returns the lower end of the legend in pixels.
double draw_legend(Sheet& sheet, glm::dvec2 top_left, const Survey& survey, const SceneMarks& marks,
                   bool is_seabed_coarse);

/// Returns a description of the origin of the coordinates.
std::string frame_words(const Scene& scene);

}  // namespace tubefoot
