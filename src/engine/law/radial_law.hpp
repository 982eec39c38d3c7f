// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/echo/echo.hpp"
#include "geometry/integrals/range_cut.hpp"

namespace tubefoot {

/// Borders of the range samples: first + k step, one more than samples.
std::vector<double> sample_borders_m(const RangeSamples& samples);

/// beta [1/m] of the two-way energy factor exp(-beta r) = 10^(-2 alpha r / 10), alpha in dB/m one way.
double two_way_absorption_per_m(double absorption_db_per_m);

/// What of a Lambert facet's echo depends on range alone. On a facet plane at distance D the sine of the
/// grazing angle is D/r, so the energy from an area element is
///     mu (D/r)^2 r^-4 e^(-beta r) dA = mu D^2 g(r) dA,   g(r) = r^-6 e^(-beta r),
/// and g serves every facet. Throws std::invalid_argument for samples that have no extent or a negative
/// range.
RadialIntegral lambert_radial_integral(const RangeSamples& samples, double absorption_db_per_m);

}  // namespace tubefoot
