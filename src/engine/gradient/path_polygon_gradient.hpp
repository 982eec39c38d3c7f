// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <glm/vec2.hpp>
#include <span>
#include <utility>
#include <vector>

#include "engine/echo/path_on_facet.hpp"
#include "engine/echo/texture_cells.hpp"
#include "engine/scattering/reflectivity_gradient.hpp"
#include "engine/scattering/scattering_derivative.hpp"
#include "geometry/integrals/path_cut.hpp"

namespace tubefoot {

/// Derivatives of the energies of one polygon that two apexes see, by range bin. With Lambert's law, they are
/// those for a Lambert parameter of 1. Places have coordinates q about the foot point of the transmit apex,
/// in a frame that moves with the plane.
struct PathDerivatives {
  /// Numbers of a bin.
  enum : std::size_t {
    energy,
    by_absorption,                ///< by beta, per metre
    by_borders,                   ///< by the relative change of all borders of range bins
    by_tx_distance,               ///< of the transmit apex from the plane, at fixed q
    by_rx_distance,               ///< of the receive apex from the plane, at fixed q
    by_foot,                      ///< by the two coordinates of the foot point of the receive apex
    own_parameters = by_foot + 2  ///< by parameters of the scattering model
  };
  /// Numbers after those of own parameters, with a texture.
  enum : std::size_t {
    by_tilt,                ///< by the components along u and v of a change of the plane's normal
    by_place = by_tilt + 2  ///< by a translation of both apexes against the texture
  };
  /// Numbers after all others, over rough mirrors.
  enum : std::size_t {
    by_roughness,                       ///< by the relative change of the roughness (MirrorLoss)
    by_rough_normal = by_roughness + 1  ///< by the components in space of each normal: of the transmit leg,
                                        ///< then of the receive leg, with apexes and plane at rest
  };
  /// Derivatives by the corners of the line of an edge (PathEdge).
  struct Part {
    std::size_t bin, edge;
    glm::dvec2 by_from, by_to;
  };

  std::size_t first_bin = 0, end_bin = 0, count = own_parameters;
  std::size_t texture = 0;      ///< place of by_tilt; 0 without texture
  std::size_t loss = 0;         ///< place of by_roughness; 0 without rough mirrors
  std::vector<double> numbers;  ///< [bin - first_bin][number]
  std::vector<Part> parts;

  double* at(std::size_t bin) { return numbers.data() + (bin - first_bin) * count; }
};

/// Two points of the line of an edge. The edge moves with the line between these points.
struct PathEdge {
  glm::dvec2 from{0}, to{0};
};

/// Differentiates energies of polygons for two apexes (docs/notes/gradients.md). An object contains scratch
/// memory: use one per thread.
class PathPolygonGradient {
 public:
  /// `tolerance`: relative error of quadratures. `mirrors_angle_rad`: smooth_angle_rad() of the path.
  /// `borders` must outlive this object.
  PathPolygonGradient(std::span<const double> borders, double tolerance, double mirrors_angle_rad)
      : borders_(borders), tolerance_(tolerance), mirrors_angle_rad_(mirrors_angle_rad), cutter_(borders) {}

  /// Computes the derivatives of one polygon. Edge k of the polygon lies on the line of edges[k]. Returns
  /// null if no bin receives energy from it. The result is valid until the next call.
  const PathDerivatives* of(const PlanarPolygon& polygon, std::span<const PathEdge> edges,
                            const PathOnFacet& path, std::span<const ScatteringDerivative* const> parameters);

 private:
  using Function = std::function<void(double x, std::span<double> values)>;

  const ReflectivityGradient* texture_of(const PathOnFacet& path);
  void add_area(const PlanarPolygon& polygon, const PathOnFacet& path,
                std::span<const ScatteringDerivative* const> parameters, const ReflectivityGradient* texture);
  void add_edges(const PlanarPolygon& polygon, std::span<const PathEdge> edges, const PathOnFacet& path);
  void add_arcs(const PlanarPolygon& polygon, const PathOnFacet& path);
  void find_arcs(const PlanarPolygon& polygon, const PathOnFacet& path, double border);
  void integrate(double from, double to, const Function& function, std::span<double> sum, int halvings = 0);

  std::span<const double> borders_;
  double tolerance_, mirrors_angle_rad_;
  PathCutter cutter_;
  PathDerivatives out_;
  TextureCells cells_;
  std::vector<std::pair<const ReflectivityField*, ReflectivityGradient>> textures_;
  std::vector<double> sums_;  // all 0 between polygons
  std::vector<double> breaks_, scale_, values_, fine_, coarse_;
};

}  // namespace tubefoot
