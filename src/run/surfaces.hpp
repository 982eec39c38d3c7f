// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "run/survey.hpp"

namespace tubefoot {

/// Whether it can be said where the beams of a sensor have no surface any more: in isovelocity water, where
/// receiver and transmitter are in one place and all of the terrain is in memory.
bool surfaces_are_known(const Survey& survey, std::size_t sensor);

/// Of each beam of a ping, how many range samples from the first on may hold a surface: up to the farthest
/// point of any facet in the beam's tubes, whether it is seen, hidden or turned away. Shadow lies on a
/// surface; where none is left it is open water, or ground outside of the scene. `energy`, [beam][sample] of
/// that ping: what echoed is not looked for. Relief that transmissions refine for themselves is not in the
/// facets that are asked.
std::vector<int> samples_with_surfaces(const Survey& survey, std::size_t sensor, std::size_t ping,
                                       std::span<const double> energy);

}  // namespace tubefoot
