// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "compare/echo_pairs.hpp"
#include "compare/recipes/recipe_file.hpp"

namespace tubefoot {

/// Puts what the recipe makes of the reference's energies and bounds in their place, for the sensors of
/// `pairs`, which are of `reference`. Throws InputError where a step lacks solid angles, or where these are
/// not of the reference's pings, beams and samples.
void apply_recipe(const Recipe& recipe, EchoContents& reference, const EchoPairs& pairs);

}  // namespace tubefoot
