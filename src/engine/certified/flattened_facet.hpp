// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "engine/certified/certified_path_energy.hpp"
#include "engine/certified/pattern_ambiguity.hpp"

// Geometry and energy of a facet flattened between two ends (BistaticFacet), in balls. Include this heavy
// header only in .cpp files.
namespace tubefoot {

/// Returns a piece of the flattened facet as a polygon, given its corners as the transmitter sees them
/// (SharedFootprints).
CertifiedPolygon flattened(std::span<const glm::dvec3> corners_m, glm::dvec3 receiver_m,
                           const BistaticFacet& bistatic);
/// Returns the energy integrand of the facet with its proven scattering models. `model` is that of the path
/// and contains the mu of the material.
CertifiedPathEnergy energy_of(const BistaticFacet& bistatic, const BistaticEnclosure& proven,
                              const EchoModel& model, std::uint16_t material, const Ball& beta_per_m);
/// Returns the apparent positions of a polygon for the receiver.
Towards seen_rx(const CertifiedPolygon& polygon, const BistaticFacet& bistatic);
/// Returns the map from coordinates of the plane to true positions.
FacetMap map_of(const LyingPlane& lies);
/// Bounds the change of a texture over a distance of `way_m`.
double change_of(const CertifiedTexture& texture, double way_m);

}  // namespace tubefoot
