// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "engine/gradient/echo_gradient.hpp"
#include "engine/surface/refracted_surface.hpp"
#include "engine/water/apparent_motion.hpp"

// Parameters of energies in stratified water. The energies are those of the apparent surface along straight
// rays, with a factor per facet. The parameters of that surface follow from the chain rule. See
// docs/notes/gradients.md.
namespace tubefoot {

/// A parameter by its effect on true positions, and on the sound speed.
struct StratifiedParameter {
  /// Velocities of vertices are those of true positions relative to the apex.
  EchoParameter at_rest;
  std::vector<double> sound_speed_m_s{};  ///< by point of the profile; empty: no change
};

/// Returns parameters for echo_derivatives() with the mesh of an apparent surface. The refinement, and the
/// layers of each ray, stay fixed. Derivatives are not finite where several rays lead to a visible facet.
///
/// `model`: the model of the apparent surface. `surface`, `grid` and the lists of the model must outlive the
/// result. `apparent_map` made the surface, and its water must outlive the result. The result is for one
/// thread, because it computes the ray to each vertex once.
std::vector<EchoParameter> apparent_parameters(std::span<const StratifiedParameter> parameters,
                                               const ApparentSurface& surface,
                                               const ApparentMap& apparent_map, const WorldGrid& grid,
                                               const EchoModel& model);

/// Derivatives of a weighted sum of energies in stratified water.
struct StratifiedGradient {
  std::vector<glm::dvec3> by_vertex;   ///< by the true positions of ApparentSurface::truth, per metre
  glm::dvec3 by_apex{0};               ///< by the apex with its tubes, with all true positions at rest
  std::vector<double> by_sound_speed;  ///< by point of the profile, per m/s
  double by_absorption = 0;            ///< by the one-way absorption in all layers, per dB/m
  std::vector<double> by_scattering;   ///< by the given parameters of scattering models
};

/// Converts the reverse-mode gradient of an apparent surface, by the transposed chain rule. `scattering`: the
/// parameters of echo_gradient(). The other arguments are those of apparent_parameters().
StratifiedGradient stratified_gradient(const EchoGradient& gradient, const ApparentSurface& surface,
                                       const ApparentMap& apparent_map, const WorldGrid& grid,
                                       const EchoModel& model,
                                       std::span<const MaterialParameter> scattering = {});

}  // namespace tubefoot
