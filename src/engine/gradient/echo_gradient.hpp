// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "engine/echo/echo.hpp"
#include "engine/visibility/history.hpp"
#include "geometry/footprints/corner_derivatives.hpp"
#include "geometry/mesh/facet_mesh.hpp"

// Derivatives of the energies of integrate_echo() at the integer coordinates of a scene, for fixed
// combinatorics. They include the motion of all borders of visible polygons: edges, shadow borders, walls of
// tubes, and intersections of facets. They hold for one apex, Lambert's law and exact binning, without
// patterns and textures. Functions throw std::invalid_argument for other echo models, and for a history
// without names of corners (VisibilityOptions::corner_names).
namespace tubefoot {

/// A parameter of a scene, by the velocities of what it moves. Velocities are per unit of the parameter.
struct EchoParameter {
  PointVelocity velocity{};     ///< of vertices and rays relative to the apex; empty: at rest
  std::vector<double> by_mu{};  ///< of Lambert's parameter mu (linear) per material; empty: constant
  double by_absorption = 0;     ///< of the one-way absorption in dB/m
  double by_range_scale = 0;    ///< relative change of all range borders
  /// A rotation of points, in radians per unit the length of `axis`. `velocity` is rounded then.
  struct Turn {
    glm::dvec3 axis{0}, origin_m{0};
    std::function<bool(PointId)> moves{};
  };
  std::optional<Turn> turn{};  ///< empty: points move along straight lines, and `velocity` is exact

  /// Translation of the apex with its tubes, in metres along a unit vector.
  static EchoParameter sonar_translation(glm::dvec3 axis);
  /// Rotation of the tubes about an axis through the apex, in radians.
  static EchoParameter sonar_rotation(glm::dvec3 axis);
  /// Translation along an axis and rotation about it of one component of a mesh. `origin_m`: a point of the
  /// axis of rotation, relative to the apex. Throws std::invalid_argument if the component shares a vertex
  /// with another one.
  static EchoParameter object_translation(const FacetMesh& mesh, std::uint16_t component, glm::dvec3 axis);
  static EchoParameter object_rotation(const FacetMesh& mesh, std::uint16_t component, glm::dvec3 axis,
                                       glm::dvec3 origin_m);
  /// Lambert's parameter mu of a material.
  static EchoParameter material_mu(std::size_t material, std::size_t materials);
  static EchoParameter absorption() { return {{}, {}, 1, 0}; }
  /// Sound speed in m/s of a sonar whose range bins are intervals of time.
  static EchoParameter sound_speed(double sound_speed_m_s) { return {{}, {}, 0, 1 / sound_speed_m_s}; }
};

/// Forward mode. Returns the derivatives of all energies, [parameter][beam][sample].
std::vector<std::vector<double>> echo_derivatives(const FacetMesh& mesh, const History& history,
                                                  const ReceiveBeams& beams, const RangeSamples& samples,
                                                  const EchoModel& model,
                                                  std::span<const EchoParameter> parameters);

/// Derivatives of the weighted sum of an echo's energies by all points of its scene.
struct EchoGradient {
  std::vector<glm::dvec3> by_vertex;   ///< per metre
  std::vector<glm::dvec3> by_ray;      ///< of FootprintSet::name_rays, per unit of their integers
  std::vector<double> by_material_mu;  ///< by Lambert's parameter mu (linear), per material
  double by_absorption = 0;            ///< by the one-way absorption, per dB/m
};

/// Reverse mode. Returns the gradient of the sum over beams and samples of weight times energy, in one pass
/// for any number of points. `weights`: [beam][sample]. Throws std::invalid_argument for weights of another
/// number and for a weight that is not finite.
EchoGradient echo_gradient(const FacetMesh& mesh, const History& history, const ReceiveBeams& beams,
                           const RangeSamples& samples, const EchoModel& model,
                           std::span<const double> weights);

}  // namespace tubefoot
