// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/echo_gradient.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>

#include "engine/gradient/polygon_gradient.hpp"
#include "engine/scattering/density.hpp"
#include "engine/scattering/radial_model.hpp"
#include "geometry/steps/stop.hpp"

// Differentiates each visible polygon by its corners and by its plane (polygon_gradient.hpp). Forward mode
// multiplies by velocities of corners, reverse mode converts to derivatives by points
// (corner_derivatives.hpp).

namespace tubefoot {
namespace {

[[noreturn]] void reject(const std::string& what) { throw std::invalid_argument("gradient: " + what); }

void check_gradient(const History& history, const EchoModel& model) {
  check(model);
  const FootprintSet& set = history.footprints;
  if (set.corner_names.size() != set.corners_m.size())
    reject("the footprints have no names of corners: set VisibilityOptions::corner_names");
  if (!history.hits.empty()) reject("hits of rays have no borders: use the tube engine");
  if (model.patterns != nullptr || !model.reflectivity.empty() || !model.scattering.empty() ||
      model.path.over_mirrors() || model.path.rx || !model.path.facet_factor.empty())
    reject("only Lambert's law without patterns, textures, mirrors and refraction is supported");
}

/// A visible polygon with its energies and derivatives, for a Lambert parameter of 1.
struct PolygonParts {
  const Footprint& footprint;
  std::uint32_t first_corner, corners;  ///< in the footprint set
  FacetPlane plane;
  PlaneFrame frame;
  double mu;                        ///< Lambert parameter of the facet
  std::span<const double> energy;   ///< by sample
  std::span<const double> by_beta;  ///< by sample: derivative by the absorption per metre
  std::span<const PolygonGradient::Part> parts;
  /// Derivative of the energy of a sample by the distance of the plane, without the parts.
  double by_distance(std::size_t sample) const { return 2 * energy[sample] / plane.distance_m; }
  glm::dvec3 in_space(glm::dvec2 v) const { return v.x * frame.u + v.y * frame.v; }
  glm::dvec2 in_plane(glm::dvec3 v) const { return {glm::dot(v, frame.u), glm::dot(v, frame.v)}; }
};

/// Calls `use` for all polygons that return energy.
template <class Use>
void for_each_polygon(const History& history, const RangeSamples& samples, const EchoModel& model,
                      const Use& use) {
  const FootprintSet& set = history.footprints;
  const double beta = absorption_per_m(model.absorption_db_per_m);
  const std::vector<double> borders = sample_borders_m(samples);
  const auto lambert = [beta](double r) { return lambert_density(TwoWayRange<double>::of(r), beta); };
  const RadialIntegral with_range(borders, [&](double r) { return r * lambert(r); });
  const std::shared_ptr<const RadialIntegral> radial =
      lambert_radial_integral(samples, model.absorption_db_per_m);
  RangeCutter cutter(*radial), moment_cutter(with_range);
  PolygonGradient gradient(borders);
  std::vector<double> energy(std::size_t(samples.count)), by_beta(std::size_t(samples.count));
  std::vector<PolygonGradient::Part> parts;
  PlanarPolygon polygon;
  for (const Footprint& footprint : set.footprints) {
    stop_if_wanted();
    const double mu = model.seabed(footprint.facet).mu;
    if (!(footprint.plane_distance_m > 0)) continue;
    const FacetPlane plane{footprint.plane_normal, footprint.plane_distance_m};
    const PlaneFrame frame(plane);
    const double factor = plane.distance_m * plane.distance_m;
    for (std::uint32_t p = 0; p < footprint.piece_count; ++p) {
      const Piece& piece = set.pieces[footprint.first_piece + p];
      polygon.assign(std::span(set.corners_m).subspan(piece.first, piece.count), plane, frame);
      if (polygon.offsets.size() != piece.count) continue;
      std::ranges::fill(energy, 0.0);
      std::ranges::fill(by_beta, 0.0);
      cutter.add(polygon, factor, energy);
      moment_cutter.add(polygon, -2 * factor, by_beta);
      parts.clear();
      gradient.add(
          polygon, [&](double r) { return factor * lambert(r); },
          [&](const PolygonGradient::Part& part) { parts.push_back(part); });
      use(PolygonParts{footprint, piece.first, piece.count, plane, frame, mu, energy, by_beta, parts});
    }
  }
}

/// Components by vertex of a mesh. Throws std::invalid_argument if the component shares a vertex.
std::shared_ptr<const std::vector<bool>> vertices_of(const FacetMesh& mesh, std::uint16_t component) {
  auto own = std::make_shared<std::vector<bool>>(mesh.vertices.size());
  for (std::size_t f = 0; f < mesh.facets.size(); ++f)
    if (mesh.component[f] == component)
      for (const VertexId v : mesh.facets[f]) (*own)[v] = true;
  for (std::size_t f = 0; f < mesh.facets.size(); ++f)
    if (mesh.component[f] != component)
      for (const VertexId v : mesh.facets[f])
        if ((*own)[v])
          reject(fmt::format("components {} and {} share vertex {}, so that component {} cannot move alone",
                             component, mesh.component[f], v, component));
  return own;
}

constexpr double per_db = std::numbers::ln10 / 10;

EchoParameter turned(const EchoParameter::Turn& turn) {
  EchoParameter parameter{[turn](PointId id, glm::dvec3 at) {
    return turn.moves(id) ? glm::cross(turn.axis, at - turn.origin_m) : glm::dvec3(0);
  }};
  parameter.turn = turn;
  return parameter;
}

}  // namespace

EchoParameter EchoParameter::sonar_translation(glm::dvec3 axis) {
  return {[axis](PointId id, glm::dvec3) { return id & ray_bit ? glm::dvec3(0) : -axis; }};
}

EchoParameter EchoParameter::sonar_rotation(glm::dvec3 axis) {
  return turned({axis, glm::dvec3(0), [](PointId id) { return (id & ray_bit) != 0; }});
}

EchoParameter EchoParameter::object_translation(const FacetMesh& mesh, std::uint16_t component,
                                                glm::dvec3 axis) {
  return {[own = vertices_of(mesh, component), axis](PointId id, glm::dvec3) {
    return !(id & ray_bit) && (*own)[id] ? axis : glm::dvec3(0);
  }};
}

EchoParameter EchoParameter::object_rotation(const FacetMesh& mesh, std::uint16_t component, glm::dvec3 axis,
                                             glm::dvec3 origin_m) {
  return turned({axis, origin_m,
                 [own = vertices_of(mesh, component)](PointId id) { return !(id & ray_bit) && (*own)[id]; }});
}

EchoParameter EchoParameter::material_mu(std::size_t material, std::size_t materials) {
  EchoParameter parameter;
  parameter.by_mu.assign(materials, 0);
  parameter.by_mu.at(material) = 1;
  return parameter;
}

std::vector<std::vector<double>> echo_derivatives(const FacetMesh& mesh, const History& history,
                                                  const ReceiveBeams& beams, const RangeSamples& samples,
                                                  const EchoModel& model,
                                                  std::span<const EchoParameter> parameters) {
  check_gradient(history, model);
  const FootprintSet& set = history.footprints;
  const NameContext context{mesh, history.tubes.apex, set.name_rays};
  const NamedPoints points(context, history.grid_unit_m);
  const auto count = std::size_t(samples.count);
  std::vector<std::vector<double>> all(parameters.size(),
                                       std::vector<double>(std::size_t(beams.count) * count));
  // Energies scale as s^-2 if all lengths scale by s and the absorption by 1/s. Borders that move alone are
  // equivalent to points that move in the opposite sense, and to changes of both.
  std::vector<std::optional<CornerVelocity>> velocities;
  for (const EchoParameter& parameter : parameters) {
    std::optional<CornerVelocity>& velocity = velocities.emplace_back();
    if (!parameter.velocity && parameter.by_range_scale == 0) continue;
    velocity.emplace(points, [&parameter](PointId id, glm::dvec3 at) {
      glm::dvec3 v = parameter.velocity ? parameter.velocity(id, at) : glm::dvec3(0);
      if (!(id & ray_bit)) v -= parameter.by_range_scale * at;
      return v;
    });
  }
  std::vector<glm::dvec2> moved;
  for_each_polygon(history, samples, model, [&](const PolygonParts& polygon) {
    const Footprint& footprint = polygon.footprint;
    const std::uint16_t material = model.material[footprint.facet];
    for (std::size_t n = 0; n < parameters.size(); ++n) {
      const EchoParameter& parameter = parameters[n];
      const std::span<double> row = std::span(all[n]).subspan(beams.of_tube[footprint.tube] * count, count);
      const double by_mu = parameter.by_mu.empty() ? 0 : parameter.by_mu[material];
      const double by_energy = by_mu - 2 * polygon.mu * parameter.by_range_scale;
      const double by_beta = polygon.mu * per_db *
                             (parameter.by_absorption + parameter.by_range_scale * model.absorption_db_per_m);
      double distance = 0;
      if (velocities[n]) {
        const CornerVelocity::UnitPlane plane = velocities[n]->of_plane(footprint.facet);
        distance = plane.distance;
        const glm::dvec2 turned = polygon.plane.distance_m * polygon.in_plane(plane.normal);
        moved.clear();
        for (std::uint32_t c = 0; c < polygon.corners; ++c)
          moved.push_back(turned + polygon.in_plane(velocities[n]->of_corner(
                                       set.corner_names[polygon.first_corner + c], footprint.facet)));
        for (const PolygonGradient::Part& part : polygon.parts)
          row[part.bin] += polygon.mu * (glm::dot(part.by_first, moved[part.edge]) +
                                         glm::dot(part.by_second, moved[(part.edge + 1) % polygon.corners]) +
                                         part.by_distance * distance);
      }
      for (std::size_t k = 0; k < count; ++k)
        row[k] += by_energy * polygon.energy[k] + by_beta * polygon.by_beta[k] +
                  polygon.mu * distance * polygon.by_distance(k);
    }
  });
  return all;
}

EchoGradient echo_gradient(const FacetMesh& mesh, const History& history, const ReceiveBeams& beams,
                           const RangeSamples& samples, const EchoModel& model,
                           std::span<const double> weights) {
  check_gradient(history, model);
  const auto count = std::size_t(samples.count);
  if (weights.size() != std::size_t(beams.count) * count)
    reject(fmt::format("there are {} weights, expected {} x {}: one per beam and range bin", weights.size(),
                       beams.count, count));
  if (const auto bad = std::ranges::find_if_not(weights, [](double w) { return std::isfinite(w); });
      bad != weights.end())
    reject(fmt::format("weight {} is {}, expected a finite number", bad - weights.begin(), *bad));
  const FootprintSet& set = history.footprints;
  const NameContext context{mesh, history.tubes.apex, set.name_rays};
  const NamedPoints points(context, history.grid_unit_m);
  CornerAdjoint adjoint(points);
  EchoGradient gradient;
  gradient.by_material_mu.assign(model.material_mu.size(), 0);
  std::vector<glm::dvec2> by_corner;
  for_each_polygon(history, samples, model, [&](const PolygonParts& polygon) {
    const Footprint& footprint = polygon.footprint;
    const std::span<const double> weight = weights.subspan(beams.of_tube[footprint.tube] * count, count);
    double by_distance = 0, by_mu = 0, by_beta = 0;
    for (std::size_t k = 0; k < count; ++k) {
      by_distance += weight[k] * polygon.by_distance(k);
      by_mu += weight[k] * polygon.energy[k];
      by_beta += weight[k] * polygon.by_beta[k];
    }
    gradient.by_material_mu[model.material[footprint.facet]] += by_mu;
    gradient.by_absorption += polygon.mu * per_db * by_beta;
    by_corner.assign(polygon.corners, glm::dvec2(0));
    for (const PolygonGradient::Part& part : polygon.parts) {
      by_corner[part.edge] += weight[part.bin] * part.by_first;
      by_corner[(part.edge + 1) % polygon.corners] += weight[part.bin] * part.by_second;
      by_distance += weight[part.bin] * part.by_distance;
    }
    glm::dvec3 by_normal(0);
    for (std::uint32_t c = 0; c < polygon.corners; ++c) {
      const glm::dvec3 by = polygon.mu * polygon.in_space(by_corner[c]);
      by_normal += polygon.plane.distance_m * by;
      adjoint.add_corner(set.corner_names[polygon.first_corner + c], footprint.facet, by);
    }
    adjoint.add_plane(footprint.facet, by_normal, polygon.mu * by_distance);
  });
  gradient.by_vertex = adjoint.by_vertex();
  gradient.by_ray = adjoint.by_ray();
  return gradient;
}

}  // namespace tubefoot
