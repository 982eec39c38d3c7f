// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "engine/certified/apparent_enclosure.hpp"
#include "engine/certified/refracted_bins.hpp"

namespace tubefoot {

/// Encloses the echo of one transmission in stratified water. It is the energy that refracted rays bring
/// from the true facets, of which `seabed` contains the images. The function corresponds to certify_echo(),
/// with these uncertainties:
///
/// (1) A piece has the energy of its apparent facet times the enclosed factor, with that facet's scattering
///     model. Within shift_m of a border between samples it may belong to either sample.
/// (2) A micro-texture is evaluated at the point that the facet's map gives, which may be displaced by
///     place_off_m.
/// (3) Next to edges of the visible part, within the error of images, any facet there may be visible.
/// (4) If two facets are closer together than their range errors, either may hide the other.
/// (5) Everything behind a facet without a proven ray is unknown.
///
/// Beams are ideal, or have patterns of at most 1. Throws std::invalid_argument for a micro-texture that
/// cannot be enclosed, or without facet maps. `tolerance` is compared with the bounds, and determines the
/// accuracy of the pieces' integrals.
RefractedReference certify_refracted_echo(const MappedSeabed& seabed, const RayEnclosure& rays,
                                          const History& history, const VisibilityOptions& options,
                                          std::span<const std::uint32_t> beam_of_tube,
                                          const RangeSamples& samples, const EchoModel& model,
                                          const Echo& ordinary, double tolerance);

}  // namespace tubefoot
