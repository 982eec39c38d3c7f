// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "engine/certified/apparent_enclosure.hpp"
#include "engine/certified/refracted_bins.hpp"

namespace tubefoot {

/// Encloses the echo of one transmission through refracting water: the energy that curved rays bring from the
/// true facets, of which the seabed's are the mapped ones. As certify_echo(), but for what the enclosures
/// leave open:
///
/// - a piece's energy is that of its apparent facet, of that one's law, times the enclosed factor; within
///   shift_m of a border between samples it belongs to either;
/// - a micro-texture is looked up where the facet's map has the place, which may be off by place_off_m;
/// - beside edges of what is seen, closer than images may be off, any facet may be seen that reaches there;
/// - where two facets are closer together than their ranges may be off, either may hide the other;
/// - what lies behind a facet without a proven ray is not known.
///
/// Beams are ideal or weighed by patterns of at most 1. Throws std::invalid_argument for a micro-texture that
/// cannot be enclosed, or without facet maps. `tolerance` only says what to hold the bounds against, and how
/// narrow the apparent pieces' own integrals need to be.
RefractedReference certify_refracted_echo(const MappedSeabed& seabed, const RayEnclosure& rays,
                                          const History& history, const VisibilityOptions& options,
                                          std::span<const std::uint32_t> beam_of_tube,
                                          const RangeSamples& samples, const EchoModel& model,
                                          const Echo& ordinary, double tolerance);

}  // namespace tubefoot
