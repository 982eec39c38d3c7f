// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/gradient/echo_gradient.hpp"
#include "engine/visibility/bistatic_history.hpp"

// Derivatives of the energies of a transmitter and a separate receiver, as those of one apex in
// echo_gradient.hpp. Positions and velocities are relative to the transmit apex. Functions throw
// std::invalid_argument for mirrors, refraction, beam patterns and hits of rays. They also throw it for a
// history without names of edges (VisibilityOptions::corner_names).
namespace tubefoot {

/// Forward mode. Returns the derivatives of all energies, [parameter][beam][sample]. EchoParameter::velocity
/// has rays of both apexes, and receive_apex.
std::vector<std::vector<double>> echo_derivatives(const FacetMesh& mesh, const BistaticHistory& history,
                                                  const ReceiveBeams& beams, const RangeSamples& samples,
                                                  const EchoModel& model,
                                                  std::span<const EchoParameter> parameters);

/// Reverse mode. Returns the gradient of the sum over beams and samples of weight times energy. `weights`:
/// [beam][sample].
EchoGradient echo_gradient(const FacetMesh& mesh, const BistaticHistory& history, const ReceiveBeams& beams,
                           const RangeSamples& samples, const EchoModel& model,
                           std::span<const double> weights,
                           std::span<const MaterialParameter> scattering = {});

/// Motion of one end of the paths of a history: of an apex, or of its image in mirrors. Velocities are per
/// unit of a parameter, which has a number.
class EndMotion {
 public:
  virtual ~EndMotion() = default;
  /// Selects the tube of the end, or the window of the image, to which the other functions refer. Returns
  /// whether this changes velocities.
  virtual bool select(std::uint32_t tube) = 0;
  /// Returns the velocity of the end relative to the transmitter.
  virtual glm::dvec3 of_end(std::size_t parameter) const = 0;
  /// Returns the velocity of a point relative to the end (PointVelocity). Ray r is number r of
  /// SharedFootprints::transmit_rays or receive_rays.
  virtual glm::dvec3 of_point(std::size_t parameter, PointId id, glm::dvec3 at) const = 0;
  /// Returns the velocity of MirrorLoss::rough_normals.
  virtual glm::dvec3 of_rough_normal(std::size_t, std::size_t) const { return glm::dvec3(0); }
  /// Returns the part of the mesh that contributes further points (NamedPoints).
  virtual const FacetMesh* part() const { return nullptr; }
};

/// Forward mode between two ends that move in a given way, also over mirrors. Adds the derivatives to `all`,
/// [parameter][beam][sample]. EchoParameter::velocity is not read.
void add_echo_derivatives(const FacetMesh& mesh, const BistaticHistory& history, const ReceiveBeams& beams,
                          const RangeSamples& samples, const EchoModel& model,
                          std::span<const EchoParameter> parameters, EndMotion& tx, EndMotion& rx,
                          std::vector<std::vector<double>>& all);

/// Derivatives of one value by the velocities of an EndMotion.
class EndAdjoint {
 public:
  virtual ~EndAdjoint() = default;
  /// Selects the tube of the end, or the window of the image, for the other functions.
  virtual void select(std::uint32_t tube) = 0;
  virtual void add_end(glm::dvec3 by) = 0;
  virtual void add_point(PointId id, glm::dvec3 by) = 0;
  virtual void add_rough_normal(std::size_t, glm::dvec3) {}
  virtual const FacetMesh* part() const { return nullptr; }
};

/// Reverse mode between such ends. Adds to `gradient`, except for derivatives by points and by the receiver.
/// EchoGradient::by_material_mu and by_scattering must have their sizes.
void add_echo_gradient(const FacetMesh& mesh, const BistaticHistory& history, const ReceiveBeams& beams,
                       const RangeSamples& samples, const EchoModel& model, std::span<const double> weights,
                       std::span<const MaterialParameter> scattering, EndAdjoint& tx, EndAdjoint& rx,
                       EchoGradient& gradient);

}  // namespace tubefoot
