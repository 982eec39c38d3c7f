// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace tubefoot {

// Diffraction at the straight edge of an opaque half-plane, by Fresnel-Kirchhoff theory (Born and Wolf,
// Principles of Optics, 8.7.3). The Fresnel parameter nu of a place is dimensionless: negative on the
// insonified side of the shadow border, positive in the shadow.

/// Returns the one-way intensity behind a half-plane, relative to that without the half-plane:
///     I(nu) = ((1/2 - C(nu))^2 + (1/2 - S(nu))^2) / 2,
/// with the Fresnel integrals C and S. The relative error is below 1e-12 for |nu| <= 100.
double knife_edge_intensity(double nu);

/// Returns knife_edge_intensity() from a table. The absolute error is below 1e-8 for knife_edge_lit_limit <=
/// nu
/// <= knife_edge_shadow_limit. Outside of these limits, the result is 1 or 0.
double truncated_knife_edge_intensity(double nu);

/// The largest parameter of a place in the shadow that receives energy. There, the two-way intensity is 50 dB
/// below that without the half-plane.
constexpr double knife_edge_shadow_limit = 4;
/// The smallest parameter of a place outside of the shadow whose energy changes. There, the intensity equals
/// that without the half-plane, so that the truncated weight is continuous. The integral of the omitted
/// change I^2 - 1 over nu is 0.03.
constexpr double knife_edge_lit_limit = -4.304362060791853;

/// Statement about energies with shadow = "fresnel", for `check`, stats.json and echoes.nc.
constexpr std::string_view fresnel_statement =
    "weighted by Fresnel diffraction at silhouette edges; the energies are not certified";

}  // namespace tubefoot
