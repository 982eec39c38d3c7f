// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "engine/scattering/range_samples.hpp"
#include "geometry/integrals/range_cut.hpp"

namespace tubefoot {

/// Returns the part of a Lambert facet's echo that depends on range alone. On a facet plane at distance D the
/// sine of the grazing angle is D/r, so the energy from an area element is
///     mu (D/r)^2 r^-4 e^(-2 beta r) dA = mu D^2 g(r) dA,   g(r) = r^-6 e^(-2 beta r).
/// The function g is the same for every facet and for every ping of a sensor. Its computation takes as long
/// as a small ping. Recently used results are therefore cached, up to `most_cells_kept` cells in total and in
/// any case the last result. A cell takes some 290 bytes; a sample usually has one cell. Thread-safe. Throws
/// std::invalid_argument for samples without extent or with a negative range.
std::shared_ptr<const RadialIntegral> lambert_radial_integral(const RangeSamples& samples,
                                                              double absorption_db_per_m);
constexpr std::size_t most_cells_kept = std::size_t{1} << 17;

}  // namespace tubefoot
