// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/signal/smooth_surface.hpp"
#include "geometry/numbers/ball.hpp"

// Encloses the reflection factor of a smooth surface. Heavy: include only in .cpp files.
namespace tubefoot {

/// SmoothSurface::factor() in ball arithmetic. For a fluid the modulus is at most 1 for any `sine`.
ComplexBall certified_factor(const SmoothSurface& surface, const Ball& sine, const Ball& wave_number);

}  // namespace tubefoot
