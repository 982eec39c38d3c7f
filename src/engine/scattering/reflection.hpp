// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>

#include "engine/scattering/sediment.hpp"

namespace tubefoot {

/// Plane-wave pressure reflection coefficient of a flat fluid seabed with loss (Rayleigh; APL-UW TR 9407,
/// section IV): with a = speed_ratio / (1 + i loss) and P = sqrt(a^-2 - cos^2), (density_ratio sin / P - 1) /
/// (density_ratio sin / P + 1). 1 at grazing angle 0 would be -1. Its modulus is at most 1.
std::complex<double> reflection_coefficient(const FluidSediment& seabed, double grazing_rad);

/// Share of the energy that is reflected, the coefficient's squared modulus.
double reflected_energy(const FluidSediment& seabed, double grazing_rad);

}  // namespace tubefoot
