// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/description/scene_component.hpp"
#include "scene/description/terrain_description.hpp"

namespace tubefoot {

/// Returns a horizontal rectangle: two facets, or a regular grid of cells no longer than `cell_m` with two
/// facets each. Throws InputError at `place` for an extent that is not positive, and for more than 50
/// million cells.
ComponentMesh flat_facets(const FlatTerrain& terrain, const SourcePlace& place);

/// Returns fractional Brownian relief on a regular grid: a sum of octaves of gradient noise from the
/// largest wavelength down to two cells. Each octave has half the wavelength and 2^-hurst times the height
/// of the previous one, and is shifted and rotated.
/// Heights have mean 0 and the given rms about `centre_m`; ripples are added. The same seed gives the same
/// seabed on every machine. Throws InputError as flat_facets() does, and for a Hurst exponent outside of
/// [0, 1].
ComponentMesh fractal_facets(const FractalTerrain& terrain, const SourcePlace& place);

}  // namespace tubefoot
