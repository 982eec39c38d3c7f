// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "engine/scattering/range_samples.hpp"
#include "geometry/integrals/range_cut.hpp"

namespace tubefoot {

/// What of a Lambert facet's echo depends on range alone. On a facet plane at distance D the sine of the
/// grazing angle is D/r, so the energy from an area element is
///     mu (D/r)^2 r^-4 e^(-2 beta r) dA = mu D^2 g(r) dA,   g(r) = r^-6 e^(-2 beta r),
/// and g serves every facet, and every ping of a sensor, though making it takes as long as a small ping: so
/// those that were asked for last are kept, up to `most_cells_kept` cells (some 290 bytes each; mostly one a
/// sample) and the last one. Thread-safe. Throws std::invalid_argument for samples that have no extent or a
/// negative range.
std::shared_ptr<const RadialIntegral> lambert_radial_integral(const RangeSamples& samples,
                                                              double absorption_db_per_m);
constexpr std::size_t most_cells_kept = std::size_t{1} << 17;

}  // namespace tubefoot
