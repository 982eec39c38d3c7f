// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>

#include "engine/scattering/sediment.hpp"

namespace tubefoot {

/// Returns the plane-wave pressure reflection coefficient of a flat fluid seabed with loss (Rayleigh; APL-UW
/// TR 9407, section IV):
///     (density_ratio sin / P - 1) / (density_ratio sin / P + 1),
/// with a = speed_ratio / (1 + i loss) and P = sqrt(a^-2 - cos^2). The coefficient is -1 at grazing angle 0.
/// Its modulus is at most 1.
std::complex<double> reflection_coefficient(const FluidSediment& seabed, double grazing_rad);

}  // namespace tubefoot
