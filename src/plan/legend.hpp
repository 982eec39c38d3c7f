// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec2.hpp>
#include <string>

#include "plan/marks.hpp"
#include "plan/sheet.hpp"

namespace tubefoot {

/// What the colours and lines of a drawing mean: sensors with their windows, seabed by height, and the rest
/// as far as the scene has it. Returns how far down it reaches.
double draw_legend(Sheet& sheet, glm::dvec2 top_left, const Survey& survey, const SceneMarks& marks,
                   bool is_seabed_coarse);

/// What the drawing's numbers count from.
std::string frame_words(const Scene& scene);

}  // namespace tubefoot
