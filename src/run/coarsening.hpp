// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/fleet.hpp"
#include "run/site.hpp"

// Facets that no sonar tells apart, taken away: docs/coarse.md.
namespace tubefoot {

/// By facet of the site's mesh, grid units: the least that any sensor tells apart on it, over all
/// transmissions: a sample of range, or the width of the narrowest beam at the facet's nearest point,
/// whichever is less. 0 for facets out of every transmission's reach.
std::vector<double> told_apart(const Site& site, const Fleet& fleet);

/// In place of the site's facets: fewer, of which no point is moved by more than `tolerance` times what is
/// told apart there, nor turned by more than the square root of the tolerance in radians. What comes near
/// another component or material, in space or by a border, moves half the way there at most. Not on sites
/// whose facets are to be told apart later (abilities.hpp): they stay as they are.
void coarsen(Site& site, const Fleet& fleet, double tolerance);

}  // namespace tubefoot
