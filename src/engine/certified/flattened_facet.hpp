// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "engine/certified/certified_path_energy.hpp"
#include "engine/certified/pattern_ambiguity.hpp"

// A facet flattened between two ends (BistaticFacet), in balls. Heavy: include only in .cpp files.
namespace tubefoot {

/// A piece of it by its corners as the transmitter sees them (SharedFootprints).
CertifiedPolygon flattened(std::span<const glm::dvec3> corners_m, glm::dvec3 receiver_m,
                           const BistaticFacet& bistatic);
/// What it returns, by the law that was proven of it; `model`: of the path, of which a material's mu.
CertifiedPathEnergy energy_of(const BistaticFacet& bistatic, const BistaticEnclosure& proven,
                              const EchoModel& model, std::uint16_t material, const Ball& beta_per_m);
/// Where the receiver sees a polygon on it.
Towards seen_rx(const CertifiedPolygon& polygon, const BistaticFacet& bistatic);
/// From the plane's coordinates to where its places lie.
FacetMap map_of(const LyingPlane& lies);
/// No texture changes by more on a way of that length.
double change_of(const CertifiedTexture& texture, double way_m);

}  // namespace tubefoot
