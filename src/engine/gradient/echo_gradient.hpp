// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "engine/echo/echo.hpp"
#include "engine/scattering/scattering_derivative.hpp"
#include "engine/visibility/history.hpp"
#include "geometry/footprints/corner_derivatives.hpp"
#include "geometry/mesh/facet_mesh.hpp"

// Derivatives of the energies of integrate_echo() at the integer coordinates of a scene, for fixed
// combinatorics. They include the motion of all borders of visible polygons: edges, shadow borders, walls of
// tubes, and intersections of facets. They hold for one apex and exact binning, with any scattering model,
// beam patterns, and textures that are maps or Perlin noise. The directions that BeamPatterns::least selects
// turn with the patterns.
// Textures stay at their place in the local frame if an object moves. On an apparent surface, points are
// apparent positions (apparent_parameters.hpp). EchoModel::pattern_tolerance is the tolerance of quadratures
// with patterns and textures.
// Functions throw std::invalid_argument for mirrors, receiver pairs and hits of rays. They also throw it for
// a history without names of corners (VisibilityOptions::corner_names), and for textures on an apparent
// surface without Leg::facet_map.
namespace tubefoot {

/// The receive apex of a history with two apexes, among the points of an EchoParameter. It moves relative to
/// the transmit apex.
constexpr PointId receive_apex = no_point;

/// A parameter of a material's scattering model.
struct MaterialParameter {
  std::size_t material = 0;
  ScatteringDerivative derivative;
};

/// A parameter of a scene, by the velocities of what it moves. Velocities are per unit of the parameter.
struct EchoParameter {
  PointVelocity velocity{};     ///< of vertices and rays relative to the apex; empty: at rest
  std::vector<double> by_mu{};  ///< of Lambert's parameter mu (linear) per material; empty: constant
  double by_absorption = 0;     ///< of the one-way absorption in dB/m
  double by_range_scale = 0;    ///< relative change of all range borders
  double by_roughness = 0;      ///< relative change of MirrorLoss::roughness
  /// A rotation of points, in radians per unit the length of `axis`. `velocity` is rounded then.
  struct Turn {
    glm::dvec3 axis{0}, origin_m{0};
    std::function<bool(PointId)> moves{};
  };
  std::optional<Turn> turn{};   ///< empty: points move along straight lines, and `velocity` is exact
  glm::dvec3 apex_velocity{0};  ///< of the apex in the local frame, to which textures and the sea surface
                                ///< are fixed
  /// Rotation vector of the axes of beam patterns about the apex, in radians.
  glm::dvec3 pattern_rotation{0};
  std::vector<MaterialParameter> by_scattering{};  ///< parameters of models that change at the rate 1
  /// Relative change of Path::facet_factor; empty: constant.
  std::function<double(FacetId)> by_facet_factor{};
  /// Velocity of the true position of an apparent vertex in the local frame, for textures; empty: at rest.
  std::function<glm::dvec3(VertexId)> true_velocity{};

  /// Translation of the apex with its tubes and patterns, in metres along a unit vector.
  static EchoParameter sonar_translation(glm::dvec3 axis);
  /// Rotation of tubes and patterns about an axis through the apex, in radians. A separate receive apex turns
  /// too.
  static EchoParameter sonar_rotation(glm::dvec3 axis);
  /// Rotation of tubes and patterns of each apex about an axis through this apex.
  static EchoParameter mounting_rotation(glm::dvec3 axis);
  /// Rotation of the patterns alone, for example a tilt of the transmit beam.
  static EchoParameter patterns_rotation(glm::dvec3 axis);
  /// Translation along an axis and rotation about it of one component of a mesh. `origin_m`: a point of the
  /// axis of rotation, relative to the apex. Throws std::invalid_argument if the component shares a vertex
  /// with another one.
  static EchoParameter object_translation(const FacetMesh& mesh, std::uint16_t component, glm::dvec3 axis);
  static EchoParameter object_rotation(const FacetMesh& mesh, std::uint16_t component, glm::dvec3 axis,
                                       glm::dvec3 origin_m);
  /// Lambert's parameter mu of a material.
  static EchoParameter material_mu(std::size_t material, std::size_t materials);
  /// A parameter of the scattering model of a material.
  static EchoParameter material_scattering(MaterialParameter parameter);
  static EchoParameter absorption();
  /// Sound speed in m/s of a sonar whose range bins are intervals of time. The frequency is constant.
  static EchoParameter sound_speed(double sound_speed_m_s);
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
  glm::dvec3 by_apex{0};               ///< by a motion of the apex in the local frame, with all points at
                                       ///< rest relative to the apex, per metre: 0 without textures and
                                       ///< sea surface
  glm::dvec3 by_pattern_rotation{0};   ///< by rotations of the patterns' axes about x, y and z, per radian
  double by_range_scale = 0;           ///< by the relative change of all range borders
  double by_roughness = 0;             ///< by the relative change of MirrorLoss::roughness
  std::vector<double> by_material_mu;  ///< by Lambert's parameter mu (linear), per material
  double by_absorption = 0;            ///< by the one-way absorption, per dB/m
  std::vector<double> by_scattering;   ///< by the given parameters of scattering models
  /// By the relative change of Path::facet_factor, per facet; empty without factors.
  std::vector<double> by_facet_factor{};
  /// By the true positions of apparent vertices against the textures, per metre; empty without textures.
  std::vector<glm::dvec3> by_true_vertex{};
  // For a history with two apexes. `by_ray` is of the transmitter then.
  std::vector<glm::dvec3> by_receive_ray{};  ///< of SharedFootprints::receive_rays
  glm::dvec3 by_receiver{0};                 ///< by the receive apex with its rays, per metre
};

/// Reverse mode. Returns the gradient of the sum over beams and samples of weight times energy, in one pass
/// for any number of points. `weights`: [beam][sample]. Throws std::invalid_argument for weights of another
/// number and for a weight that is not finite.
/// `scattering`: parameters of scattering models.
EchoGradient echo_gradient(const FacetMesh& mesh, const History& history, const ReceiveBeams& beams,
                           const RangeSamples& samples, const EchoModel& model,
                           std::span<const double> weights,
                           std::span<const MaterialParameter> scattering = {});

}  // namespace tubefoot
