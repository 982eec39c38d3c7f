// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace tubefoot {

/// Lambert's law: backscattering cross-section per unit area = mu sin(grazing in) sin(grazing out). A seabed
/// that scatters all received energy has pi mu = 1, so mu <= 1/pi, or 10 log10 mu <= -4.9715 dB.
inline constexpr double largest_lambert_mu = 0.31830988618379067;

/// Returns mu (linear) from Lambert's parameter in dB, 10 log10 mu. Mackenzie's deep-sea seabed has -27 dB.
double lambert_mu(double lambert_db);

/// Returns the backscattering cross-section per unit area for transmitter and receiver at one position.
double lambert_cross_section(double mu, double grazing_angle_rad);

}  // namespace tubefoot
