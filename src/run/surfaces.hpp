// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "run/survey.hpp"

namespace tubefoot {

/// Returns whether the range is known beyond which the beams of a sensor contain no surface. This is the
/// case in isovelocity water with a monostatic sensor and with all terrain in memory.
bool surfaces_are_known(const Survey& survey, std::size_t sensor);

/// Returns, by beam of a ping, the number of range samples from the first on that may contain a surface.
/// This number extends to the farthest point of any facet in the tubes of the beam, whether the facet is
/// visible, hidden or faces away. Shadow lies on a surface. Beyond the last surface there is open water, or
/// seabed outside of the scene. `energy`: the energies [beam][sample] of that ping; ranges with an echo are
/// not searched. Relief that each transmission refines for itself is not considered.
std::vector<int> samples_with_surfaces(const Survey& survey, std::size_t sensor, std::size_t ping,
                                       std::span<const double> energy);

}  // namespace tubefoot
