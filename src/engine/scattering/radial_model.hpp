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

/// The parts of the volume reverberation in front of a facet that depend on range alone, on the same cells.
/// On a facet plane at distance D, an area element has the solid angle D r^-3 dA. In a sample that begins at
/// r_k, the water in front of it returns s_v D g(r) dA with
///     g(r) = r^-3 (integral of s^-2 e^(-2 beta s) ds from r_k to r).
struct VolumeRadials {
  RadialIntegral solid_angle, partial;
  const std::vector<RadialIntegral::Cell>& cells() const { return solid_angle.cells(); }
};

/// Returns both parts. `samples` must begin above 0. Recently used results are cached.
std::shared_ptr<const VolumeRadials> volume_radial_integrals(const RangeSamples& samples,
                                                             double absorption_db_per_m);
/// Solid angles beyond the samples extend to this multiple of their end.
constexpr double farthest_over_last = 1 << 20;
/// Returns the begin of the sample that contains a range.
double sample_start_m(std::span<const double> borders_m, double range_m);

constexpr std::size_t most_cells_kept = std::size_t{1} << 17;

}  // namespace tubefoot
