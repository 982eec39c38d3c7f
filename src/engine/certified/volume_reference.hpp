// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/certified/reference.hpp"
#include "engine/scattering/volume_scattering.hpp"

namespace tubefoot {

/// Encloses the volume reverberation of one ping (volume_echo.hpp) in isovelocity water, with exact
/// visibility and integrals in ball arithmetic. The bounds have the tolerance of certify_echo(), relative to
/// the volume reverberation alone. `ordinary`: result of volume_echo() for the same arguments, which guides
/// the work. `options` must name an exact arithmetic.
CertifiedEcho certify_volume(const FacetMesh& mesh, const SceneTree& tree, const History& history,
                             const VisibilityOptions& options, std::span<const std::uint32_t> beam_of_tube,
                             const RangeSamples& samples, const EchoModel& model,
                             const VolumeScattering& volume, const Echo& ordinary, double tolerance);

}  // namespace tubefoot
