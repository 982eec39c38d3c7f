// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/echo_gradient.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/gradient/beam_gains.hpp"
#include "engine/gradient/checked_arguments.hpp"
#include "engine/gradient/polygon_gradient.hpp"
#include "geometry/steps/stop.hpp"

// Differentiates each visible polygon by its corners and by its plane (polygon_gradient.hpp). Forward mode
// multiplies by velocities of corners, reverse mode converts to derivatives by points
// (corner_derivatives.hpp).

namespace tubefoot {
namespace {

void check_gradient(const History& history, const EchoModel& model) {
  check(model);
  const FootprintSet& set = history.footprints;
  if (set.corner_names.size() != set.corners_m.size())
    reject_gradient("the footprints have no names of corners: set VisibilityOptions::corner_names");
  if (!history.hits.empty()) reject_gradient("hits of rays have no borders: use the tube engine");
  if (model.path.over_mirrors() || model.path.rx)
    reject_gradient("mirrors and a receive leg of its own are not supported");
  if (!model.path.facet_factor.empty() && model.path.tx.facet_map.empty() &&
      std::ranges::any_of(model.reflectivity, [](const auto& texture) { return texture != nullptr; }))
    reject_gradient("textures on an apparent surface need maps to true positions");
}

/// A visible polygon and its derivatives.
struct DifferentiatedPolygon {
  const Footprint& footprint;
  std::uint32_t first_corner, corners;  ///< in the footprint set
  const FacetPlane& plane;
  const PlaneFrame& frame;
  /// Factor of the derivatives: Path::facet_factor, times Lambert's parameter with Lambert's law.
  double scale;
  double facet_factor;
  bool lambert;
  std::uint16_t material;
  bool displaced;  ///< whether a texture refers to true positions that differ from apparent ones
  const PolygonDerivatives& by;
  glm::dvec3 in_space(glm::dvec2 v) const { return v.x * frame.u + v.y * frame.v; }
  glm::dvec2 in_plane(glm::dvec3 v) const { return {glm::dot(v, frame.u), glm::dot(v, frame.v)}; }
};

glm::dvec3 vector_at(const double* numbers) { return {numbers[0], numbers[1], numbers[2]}; }

/// Calls `use` for all polygons that return energy.
template <class Use>
void for_each_polygon(const History& history, const RangeSamples& samples, const EchoModel& model,
                      BeamGains& gains, bool absorption, const ScatteringParameters& parameters,
                      const Use& use) {
  const FootprintSet& set = history.footprints;
  PolygonGradient gradient(samples, model, gains, absorption);
  PlanarPolygon polygon;
  for (const Footprint& footprint : set.footprints) {
    stop_if_wanted();
    const SurfaceProperties surface = model.seabed(footprint.facet);
    if (!(footprint.plane_distance_m > 0)) continue;
    const std::uint16_t material = model.material[footprint.facet];
    const FacetPlane plane{footprint.plane_normal, footprint.plane_distance_m};
    const PlaneFrame frame(plane);
    const LyingPlane lies =
        surface.texture != nullptr ? model.path.tx.lying(footprint.facet, plane, frame) : LyingPlane();
    const bool lambert = surface.scattering == nullptr;
    for (std::uint32_t p = 0; p < footprint.piece_count; ++p) {
      const Piece& piece = set.pieces[footprint.first_piece + p];
      polygon.assign(std::span(set.corners_m).subspan(piece.first, piece.count), plane, frame);
      if (polygon.offsets.size() != piece.count) continue;
      gains.select(footprint.tube, std::span(set.corners_m).subspan(piece.first, piece.count));
      const bool displaced = surface.texture != nullptr && !model.path.tx.facet_map.empty();
      const PolygonDerivatives* by =
          gradient.of({polygon, plane, frame, surface, lies, displaced, parameters.of_material[material]});
      if (by != nullptr)
        use(DifferentiatedPolygon{footprint, piece.first, piece.count, plane, frame,
                                  lambert ? surface.mu : surface.factor, surface.factor, lambert, material,
                                  displaced, *by});
    }
  }
}

/// Triangle of a facet in its plane, for vectors that are linear on the facet.
class LinearOnFacet {
 public:
  LinearOnFacet(const NamedPoints& points, const DifferentiatedPolygon& polygon)
      : vertices_(points.context().mesh.facets[polygon.footprint.facet]),
        first_(polygon.in_plane(points.point(vertices_[0]))),
        a_(polygon.in_plane(points.point(vertices_[1])) - first_),
        b_(polygon.in_plane(points.point(vertices_[2])) - first_),
        area_(a_.x * b_.y - a_.y * b_.x) {}

  const std::array<VertexId, 3>& vertices() const { return vertices_; }
  /// Value at the foot point, and slopes by x and y, of the vectors at the vertices.
  std::array<glm::dvec3, 3> field(const std::array<glm::dvec3, 3>& at) const {
    const glm::dvec3 first = at[1] - at[0], second = at[2] - at[0];
    const glm::dvec3 x = (b_.y * first - a_.y * second) / area_, y = (a_.x * second - b_.x * first) / area_;
    return {at[0] - first_.x * x - first_.y * y, x, y};
  }
  /// The transposed map: derivatives by the vectors at the vertices.
  std::array<glm::dvec3, 3> by_vertex(const std::array<glm::dvec3, 3>& by_field) const {
    const glm::dvec3 x = by_field[1] - first_.x * by_field[0], y = by_field[2] - first_.y * by_field[0];
    const glm::dvec3 second = (b_.y * x - b_.x * y) / area_, third = (a_.x * y - a_.y * x) / area_;
    return {by_field[0] - second - third, second, third};
  }

 private:
  std::array<VertexId, 3> vertices_;
  glm::dvec2 first_, a_, b_;
  double area_;
};

/// Returns by vertex whether it belongs to a component. Throws std::invalid_argument if another component
/// shares one of these vertices.
std::shared_ptr<const std::vector<bool>> vertices_of(const FacetMesh& mesh, std::uint16_t component) {
  auto own = std::make_shared<std::vector<bool>>(mesh.vertices.size());
  for (std::size_t f = 0; f < mesh.facets.size(); ++f)
    if (mesh.component[f] == component)
      for (const VertexId v : mesh.facets[f]) (*own)[v] = true;
  for (std::size_t f = 0; f < mesh.facets.size(); ++f)
    if (mesh.component[f] != component)
      for (const VertexId v : mesh.facets[f])
        if ((*own)[v])
          reject_gradient(
              fmt::format("components {} and {} share vertex {}, so that component {} cannot move alone",
                          component, mesh.component[f], v, component));
  return own;
}

EchoParameter turned(const EchoParameter::Turn& turn) {
  EchoParameter parameter{[turn](PointId id, glm::dvec3 at) {
    return turn.moves(id) ? glm::cross(turn.axis, at - turn.origin_m) : glm::dvec3(0);
  }};
  parameter.turn = turn;
  return parameter;
}

}  // namespace

EchoParameter EchoParameter::sonar_translation(glm::dvec3 axis) {
  EchoParameter parameter;
  parameter.velocity = [axis](PointId id, glm::dvec3) { return id & ray_bit ? glm::dvec3(0) : -axis; };
  parameter.apex_velocity = axis;
  return parameter;
}

EchoParameter EchoParameter::sonar_rotation(glm::dvec3 axis) {
  EchoParameter parameter = turned({axis, glm::dvec3(0), [](PointId id) { return (id & ray_bit) != 0; }});
  parameter.pattern_rotation = axis;
  return parameter;
}

EchoParameter EchoParameter::mounting_rotation(glm::dvec3 axis) {
  EchoParameter parameter =
      turned({axis, glm::dvec3(0), [](PointId id) { return (id & ray_bit) != 0 && id != receive_apex; }});
  parameter.pattern_rotation = axis;
  return parameter;
}

EchoParameter EchoParameter::patterns_rotation(glm::dvec3 axis) {
  EchoParameter parameter;
  parameter.pattern_rotation = axis;
  return parameter;
}

EchoParameter EchoParameter::material_scattering(MaterialParameter changed) {
  EchoParameter parameter;
  parameter.by_scattering.push_back(std::move(changed));
  return parameter;
}

EchoParameter EchoParameter::absorption() {
  EchoParameter parameter;
  parameter.by_absorption = 1;
  return parameter;
}

EchoParameter EchoParameter::sound_speed(double sound_speed_m_s) {
  EchoParameter parameter;
  parameter.by_range_scale = 1 / sound_speed_m_s;
  parameter.by_roughness = -2 / sound_speed_m_s;  // the square of the wave number
  return parameter;
}

EchoParameter EchoParameter::object_translation(const FacetMesh& mesh, std::uint16_t component,
                                                glm::dvec3 axis) {
  EchoParameter parameter;
  parameter.velocity = [own = vertices_of(mesh, component), axis](PointId id, glm::dvec3) {
    return !(id & ray_bit) && (*own)[id] ? axis : glm::dvec3(0);
  };
  return parameter;
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
  // A rotation of the patterns is equivalent to two others. One is the opposite rotation of all points. The
  // other one is a rotation of everything about the apex against the textures.
  constexpr std::size_t at_rest = std::size_t(-1);
  std::vector<PointVelocity> velocities;
  std::vector<std::size_t> velocity_of;  // by parameter
  std::vector<glm::dvec3> rotations;
  ScatteringParameters scattering(model);
  std::vector<std::size_t> first_own;  // by parameter
  bool absorption = false;
  for (const EchoParameter& parameter : parameters) {
    absorption = absorption || parameter.by_absorption != 0;
    first_own.push_back(scattering.count);
    for (const MaterialParameter& own : parameter.by_scattering) scattering.add(own);
    const glm::dvec3 turned = model.patterns != nullptr ? parameter.pattern_rotation : glm::dvec3(0);
    rotations.push_back(turned);
    velocity_of.push_back(at_rest);
    if (!parameter.velocity && turned == glm::dvec3(0)) continue;
    velocity_of.back() = velocities.size();
    if (turned == glm::dvec3(0))
      velocities.push_back(parameter.velocity);
    else
      velocities.push_back([&parameter, turned](PointId id, glm::dvec3 at) {
        return (parameter.velocity ? parameter.velocity(id, at) : glm::dvec3(0)) - glm::cross(turned, at);
      });
  }
  first_own.push_back(scattering.count);
  CornerVelocities corners(points, velocities);
  BeamGains gains(model.patterns, beams, {}, count, model.pattern_tolerance);
  std::vector<RowSums> sums;
  for (std::vector<double>& derivatives : all) sums.emplace_back(gains, derivatives);
  std::vector<glm::dvec2> moved;  // [velocity][corner]
  std::vector<double> factor;
  for_each_polygon(
      history, samples, model, gains, absorption, scattering, [&](const DifferentiatedPolygon& polygon) {
        using Numbers = PolygonDerivatives;
        const PolygonDerivatives& by = polygon.by;
        if (!velocities.empty()) corners.select(polygon.footprint.facet);
        moved.resize(velocities.size() * polygon.corners);
        for (std::uint32_t c = 0; c < polygon.corners && !velocities.empty(); ++c) {
          const std::vector<glm::dvec3>& of = corners.of_corner(set.corner_names[polygon.first_corner + c]);
          for (std::size_t n = 0; n < of.size(); ++n)
            moved[n * polygon.corners + c] = polygon.in_plane(of[n]);
        }
        for (std::size_t n = 0; n < parameters.size(); ++n) {
          const EchoParameter& parameter = parameters[n];
          factor.assign(by.count, 0);
          factor[Numbers::by_absorption] = polygon.scale * per_db * parameter.by_absorption;
          factor[Numbers::by_borders] = polygon.scale * parameter.by_range_scale;
          const auto put = [&](std::size_t first, glm::dvec3 v) {
            for (int k = 0; k < 3; ++k) factor[first + std::size_t(k)] = polygon.scale * v[k];
          };
          if (polygon.displaced) {
            // Points of the apparent plane keep their places between the corners, so that apparent corners
            // move the texture too.
            const LinearOnFacet facet(points, polygon);
            const glm::dmat3& linear = model.path.tx.facet_map[polygon.footprint.facet].linear;
            std::array<glm::dvec3, 3> moves{};
            for (std::size_t k = 0; k < 3; ++k) {
              const VertexId v = facet.vertices()[k];
              if (parameter.true_velocity) moves[k] = parameter.true_velocity(v);
              if (velocity_of[n] != at_rest)
                moves[k] -= linear * velocities[velocity_of[n]](v, points.point(v));
            }
            const std::array<glm::dvec3, 3> field = facet.field(moves);
            for (std::size_t k = 0; k < 3; ++k) put(Numbers::by_place + 3 * k, field[k]);
          } else {
            const glm::dvec3 turn = rotations[n];
            put(Numbers::by_place,
                parameter.apex_velocity - polygon.plane.distance_m * glm::cross(turn, polygon.plane.normal));
            put(Numbers::by_place_x, glm::cross(turn, polygon.frame.u));
            put(Numbers::by_place_y, glm::cross(turn, polygon.frame.v));
          }
          if (polygon.lambert && !parameter.by_mu.empty())
            factor[Numbers::energy] = polygon.facet_factor * parameter.by_mu[polygon.material];
          if (parameter.by_facet_factor)
            factor[Numbers::energy] += polygon.scale * parameter.by_facet_factor(polygon.footprint.facet);
          const std::vector<std::size_t>& own = scattering.numbers[polygon.material];
          for (std::size_t k = 0; k < own.size(); ++k)
            if (own[k] >= first_own[n] && own[k] < first_own[n + 1])
              factor[Numbers::own_parameters + k] = polygon.facet_factor;
          if (velocity_of[n] != at_rest) {
            const CornerVelocities::UnitPlane plane = corners.of_plane(velocity_of[n]);
            const glm::dvec2 tilt = polygon.in_plane(plane.normal);
            factor[Numbers::by_distance] = polygon.scale * plane.distance;
            factor[Numbers::by_tilt] = polygon.scale * tilt.x;
            factor[Numbers::by_tilt + 1] = polygon.scale * tilt.y;
            const std::span<glm::dvec2> own_moved =
                std::span(moved).subspan(velocity_of[n] * polygon.corners, polygon.corners);
            for (glm::dvec2& corner : own_moved)
              corner = polygon.scale * (corner + polygon.plane.distance_m * tilt);
            for (const PolygonDerivatives::Part& part : by.parts) {
              const RowSums::Row row = sums[n].row(part.row);
              row.at[part.bin * row.stride] +=
                  glm::dot(part.by_first, own_moved[part.edge]) +
                  glm::dot(part.by_second, own_moved[part.edge + 1 < polygon.corners ? part.edge + 1 : 0]);
            }
          }
          const double* numbers = by.numbers.data();
          for (std::size_t bin = by.first_bin; bin < by.end_bin; ++bin)
            for (std::size_t r = 0; r < by.rows; ++r, numbers += by.count) {
              double sum = 0;
              for (std::size_t k = 0; k < by.count; ++k) sum += factor[k] * numbers[k];
              const RowSums::Row row = sums[n].row(r);
              row.at[bin * row.stride] += sum;
            }
        }
      });
  for (RowSums& each : sums) each.finish();
  return all;
}

EchoGradient echo_gradient(const FacetMesh& mesh, const History& history, const ReceiveBeams& beams,
                           const RangeSamples& samples, const EchoModel& model,
                           std::span<const double> weights, std::span<const MaterialParameter> scattering) {
  check_gradient(history, model);
  const auto count = std::size_t(samples.count);
  check_weights(weights, beams, samples);
  ScatteringParameters parameters(model);
  for (const MaterialParameter& parameter : scattering) parameters.add(parameter);
  const FootprintSet& set = history.footprints;
  const NameContext context{mesh, history.tubes.apex, set.name_rays};
  const NamedPoints points(context, history.grid_unit_m);
  CornerAdjoint adjoint(points);
  EchoGradient gradient;
  gradient.by_material_mu.assign(model.material_mu.size(), 0);
  gradient.by_scattering.assign(scattering.size(), 0);
  gradient.by_facet_factor.assign(model.path.facet_factor.size(), 0);
  BeamGains gains(model.patterns, beams, weights, count, model.pattern_tolerance);
  glm::dvec3 turned(0);
  std::vector<glm::dvec3> by_apparent;  // by apparent vertices, through the places of textures
  if (!model.path.tx.facet_map.empty()) by_apparent.assign(mesh.vertices.size(), glm::dvec3(0));
  gradient.by_true_vertex = by_apparent;
  std::vector<glm::dvec2> by_corner;
  std::vector<double> sum;
  for_each_polygon(
      history, samples, model, gains, true, parameters, [&](const DifferentiatedPolygon& polygon) {
        using Numbers = PolygonDerivatives;
        const Footprint& footprint = polygon.footprint;
        const PolygonDerivatives& by = polygon.by;
        // Rows with weighted gains contain the weights.
        const double* weight = by.weighted ? nullptr : &weights[gains.first_beam() * count];
        const auto weight_of = [&](std::size_t bin) { return weight != nullptr ? weight[bin] : 1; };
        sum.assign(by.count, 0);
        const double* numbers = by.numbers.data();
        for (std::size_t bin = by.first_bin; bin < by.end_bin; ++bin, numbers += by.count)
          for (std::size_t k = 0; k < by.count; ++k) sum[k] += weight_of(bin) * numbers[k];
        if (polygon.lambert)
          gradient.by_material_mu[polygon.material] += polygon.facet_factor * sum[Numbers::energy];
        if (!gradient.by_facet_factor.empty())
          gradient.by_facet_factor[footprint.facet] += polygon.scale * sum[Numbers::energy];
        for (std::size_t k = Numbers::by_absorption; k < Numbers::own_parameters; ++k)
          sum[k] *= polygon.scale;
        gradient.by_absorption += per_db * sum[Numbers::by_absorption];
        gradient.by_range_scale += sum[Numbers::by_borders];
        const std::array<glm::dvec3, 3> by_place{vector_at(&sum[Numbers::by_place]),
                                                 vector_at(&sum[Numbers::by_place_x]),
                                                 vector_at(&sum[Numbers::by_place_y])};
        if (polygon.displaced) {
          const LinearOnFacet facet(points, polygon);
          const glm::dmat3 transposed =
              glm::transpose(model.path.tx.facet_map[polygon.footprint.facet].linear);
          const std::array<glm::dvec3, 3> by_vertex = facet.by_vertex(by_place);
          for (std::size_t k = 0; k < 3; ++k) {
            gradient.by_true_vertex[facet.vertices()[k]] += by_vertex[k];
            by_apparent[facet.vertices()[k]] -= transposed * by_vertex[k];
          }
        } else {
          gradient.by_apex += by_place[0];
          turned += glm::cross(polygon.frame.u, by_place[1]) + glm::cross(polygon.frame.v, by_place[2]) -
                    polygon.plane.distance_m * glm::cross(polygon.plane.normal, by_place[0]);
        }
        const std::vector<std::size_t>& own = parameters.numbers[polygon.material];
        for (std::size_t k = 0; k < own.size(); ++k)
          gradient.by_scattering[own[k]] += polygon.facet_factor * sum[Numbers::own_parameters + k];
        by_corner.assign(polygon.corners, glm::dvec2(0));
        for (const PolygonDerivatives::Part& part : by.parts) {
          const double factor = polygon.scale * weight_of(part.bin);
          by_corner[part.edge] += factor * part.by_first;
          by_corner[(part.edge + 1) % polygon.corners] += factor * part.by_second;
        }
        glm::dvec3 by_normal = polygon.in_space({sum[Numbers::by_tilt], sum[Numbers::by_tilt + 1]});
        for (std::uint32_t c = 0; c < polygon.corners; ++c) {
          const glm::dvec3 by_point = polygon.in_space(by_corner[c]);
          by_normal += polygon.plane.distance_m * by_point;
          adjoint.add_corner(set.corner_names[polygon.first_corner + c], footprint.facet, by_point);
        }
        adjoint.add_plane(footprint.facet, by_normal, sum[Numbers::by_distance]);
      });
  gradient.by_vertex = adjoint.by_vertex();
  for (std::size_t v = 0; v < by_apparent.size(); ++v) gradient.by_vertex[v] += by_apparent[v];
  gradient.by_ray = adjoint.by_ray();
  if (model.patterns == nullptr) return gradient;
  // See echo_derivatives().
  gradient.by_pattern_rotation = turned;
  const auto turn = [&](PointId id, glm::dvec3 by) {
    gradient.by_pattern_rotation -= glm::cross(points.point(id), by);
  };
  for (std::size_t v = 0; v < gradient.by_vertex.size(); ++v) turn(PointId(v), gradient.by_vertex[v]);
  for (std::size_t r = 0; r < gradient.by_ray.size(); ++r) turn(PointId(r) | ray_bit, gradient.by_ray[r]);
  return gradient;
}

}  // namespace tubefoot
