// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/scattering/knife_edge.hpp"
#include "run/contributions.hpp"

// Contribution of shadow = "fresnel": the change of energies by diffraction at shadow borders
// (docs/energies.md). The energies of geometric shadows are another contribution.
namespace tubefoot {

/// Largest number of cells near shadow borders in one transmission (docs/limits.md). They need about 60 s of
/// processor time.
constexpr std::size_t most_fresnel_cells = 50000000;

/// Returns whether the energies of a sensor include diffraction at shadow borders.
bool has_fresnel_borders(const Sensor& sensor);

/// Adds the change of the energies near shadow borders. The plan must set `needs_corner_names`.
void add_fresnel_borders(const EchoContribution& plan, const Transmission& transmission, PingSums& sums);
/// The same for separate receivers. The plan need not set `needs_corner_names`.
void add_fresnel_pair_borders(const EchoContribution& plan, const Transmission& transmission, PingSums& sums);

}  // namespace tubefoot
