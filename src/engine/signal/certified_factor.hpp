// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/signal/smooth_surface.hpp"
#include "geometry/numbers/ball.hpp"

// Heavy: include only in .cpp files.
namespace tubefoot {

/// SmoothSurface::factor() in balls; of modulus at most 1 for a fluid, whatever `sine` may be.
ComplexBall certified_factor(const SmoothSurface& surface, const Ball& sine, const Ball& wave_number);

}  // namespace tubefoot
