// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/bistatic_gradient.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

#include "engine/gradient/checked_arguments.hpp"
#include "engine/gradient/path_polygon_gradient.hpp"
#include "geometry/steps/stop.hpp"

// Differentiates each polygon that both apexes see (path_polygon_gradient.hpp). Each of its edges lies on an
// edge of a visible polygon of one apex, and moves with the two named corners of that edge. The other
// variables are both distances of the plane and the foot point of the receive apex.

namespace tubefoot {
namespace {

void check_shared(const BistaticHistory& history, const EchoModel& model) {
  check(model);
  if (history.shared.edges.size() != history.shared.corners_m.size())
    reject_gradient("the shared footprints have no names of edges: set VisibilityOptions::corner_names");
  if (!history.hits.empty()) reject_gradient("hits of rays have no borders: use the tube engine");
  if (!history.bistatic.empty() || !model.path.facet_factor.empty())
    reject_gradient("refraction is not supported");
  if (model.patterns != nullptr) reject_gradient("beam patterns of a separate receiver are not supported");
}

void check_bistatic(const BistaticHistory& history, const EchoModel& model) {
  check_shared(history, model);
  if (model.path.over_mirrors()) reject_gradient("images in mirrors need an EndMotion");
}

/// The apexes of a history, and the points of names relative to each.
struct TwoApexes {
  NameContext tx_context, rx_context;
  NamedPoints tx, rx;
  glm::dvec3 rx_m;  ///< receive apex relative to the transmit apex

  TwoApexes(const FacetMesh& mesh, const BistaticHistory& history, const FacetMesh* tx_part = nullptr,
            const FacetMesh* rx_part = nullptr)
      : tx_context{mesh, history.transmit.apex, history.shared.transmit_rays},
        rx_context{mesh, history.receive.apex, history.shared.receive_rays},
        tx(tx_context, history.grid_unit_m, tx_part),
        rx(rx_context, history.grid_unit_m, rx_part),
        rx_m(history.shared.receiver_m) {}
  TwoApexes(const TwoApexes&) = delete;
  TwoApexes& operator=(const TwoApexes&) = delete;
};

/// Motion of the transmit apex, or of a receive apex at `at_m` from it.
class MovingApex : public EndMotion {
 public:
  MovingApex(std::span<const EchoParameter> parameters, glm::dvec3 at_m, bool is_receiver)
      : parameters_(parameters), at_m_(at_m), is_receiver_(is_receiver) {}
  bool select(std::uint32_t) override { return false; }
  glm::dvec3 of_end(std::size_t parameter) const override {
    const PointVelocity& velocity = parameters_[parameter].velocity;
    return is_receiver_ && velocity ? velocity(receive_apex, at_m_) : glm::dvec3(0);
  }
  glm::dvec3 of_point(std::size_t parameter, PointId id, glm::dvec3 at) const override {
    const PointVelocity& velocity = parameters_[parameter].velocity;
    if (!velocity) return glm::dvec3(0);
    return id & ray_bit ? velocity(id, at) : velocity(id, at + at_m_) - of_end(parameter);
  }

 private:
  std::span<const EchoParameter> parameters_;
  glm::dvec3 at_m_;
  bool is_receiver_;
};

/// Derivatives by the points that an apex sees, relative to it, and by the apex.
class ApexAdjoint : public EndAdjoint {
 public:
  ApexAdjoint(const FacetMesh& mesh, std::size_t rays)
      : by_vertex(mesh.vertices.size(), glm::dvec3(0)), by_ray(rays, glm::dvec3(0)) {}
  void select(std::uint32_t) override {}
  void add_end(glm::dvec3 by) override { by_end += by; }
  void add_point(PointId id, glm::dvec3 by) override {
    (id & ray_bit ? by_ray[id & ~ray_bit] : by_vertex[id]) += by;
  }

  std::vector<glm::dvec3> by_vertex, by_ray;
  glm::dvec3 by_end{0};
};

glm::dvec3 vector_of(const double* numbers) { return {numbers[0], numbers[1], numbers[2]}; }

/// A polygon that both apexes see, and its derivatives.
struct DifferentiatedPath {
  const SeenFacet& facet;
  const PlaneFrame& frame;
  std::span<const SharedEdge> edges;
  std::uint32_t tx_tube, rx_tube, beam;
  std::uint16_t material;
  /// Factor of the derivatives: Lambert's parameter, or 1 for another model.
  double scale;
  bool lambert;
  const PathDerivatives& by;

  glm::dvec3 in_space(glm::dvec2 v) const { return v.x * frame.u + v.y * frame.v; }
  glm::dvec2 in_plane(glm::dvec3 v) const { return {glm::dot(v, frame.u), glm::dot(v, frame.v)}; }
  double distance() const { return facet.plane.distance_m; }
  /// Difference of the distances of both apexes from the plane.
  double descent() const { return facet.plane.distance_m - facet.rx_distance_m; }
};

/// Calls `use` for all polygons that return energy.
template <class Use>
void for_each_path(const BistaticHistory& history, const ReceiveBeams& beams, const RangeSamples& samples,
                   const EchoModel& model, const ScatteringParameters& parameters, const Use& use) {
  const CommonVisibility visibility(history);
  const std::vector<double> borders = sample_borders_m(samples);
  PathPolygonGradient gradient(borders, bistatic_tolerance, smooth_angle_rad(model.path));
  PlanarPolygon polygon;
  std::vector<PathEdge> lines;
  for (std::size_t number = visibility.first(); number < visibility.end(); ++number) {
    stop_if_wanted();
    const SeenFacet facet = visibility[number];
    const PlaneFrame frame(facet.plane);
    PathOnFacet path = path_on(visibility, number, frame, model);
    const bool lambert = path.seabed.scattering == nullptr;
    const double scale = lambert ? std::exchange(path.seabed.mu, 1) : 1;
    const std::uint16_t material = model.material[facet.facet];
    for (std::uint32_t k = 0; k < facet.piece_count; ++k) {
      const SharedPiece& piece = history.shared.pieces[facet.first_piece + k];
      if (!beams.in_one_fan(piece.transmit_tube, piece.receive_tube)) continue;
      polygon.assign(std::span(history.shared.corners_m).subspan(piece.first, piece.count), facet.plane,
                     frame);
      const std::span<const SharedEdge> edges =
          std::span(history.shared.edges).subspan(piece.first, piece.count);
      lines.clear();
      for (const SharedEdge& edge : edges)
        lines.push_back({frame.project(edge.from_m), frame.project(edge.to_m)});
      const PathDerivatives* by = gradient.of(polygon, lines, path, parameters.of_material[material]);
      if (by != nullptr)
        use(DifferentiatedPath{facet, frame, edges, piece.transmit_tube, piece.receive_tube,
                               beams.of_tube[piece.receive_tube], material, scale, lambert, *by});
    }
  }
}

}  // namespace

std::vector<std::vector<double>> echo_derivatives(const FacetMesh& mesh, const BistaticHistory& history,
                                                  const ReceiveBeams& beams, const RangeSamples& samples,
                                                  const EchoModel& model,
                                                  std::span<const EchoParameter> parameters) {
  check_bistatic(history, model);
  std::vector<std::vector<double>> all(
      parameters.size(), std::vector<double>(std::size_t(beams.count) * std::size_t(samples.count)));
  MovingApex tx(parameters, glm::dvec3(0), false), rx(parameters, history.shared.receiver_m, true);
  add_echo_derivatives(mesh, history, beams, samples, model, parameters, tx, rx, all);
  return all;
}

void add_echo_derivatives(const FacetMesh& mesh, const BistaticHistory& history, const ReceiveBeams& beams,
                          const RangeSamples& samples, const EchoModel& model,
                          std::span<const EchoParameter> parameters, EndMotion& tx_end, EndMotion& rx_end,
                          std::vector<std::vector<double>>& all) {
  using Numbers = PathDerivatives;
  check_shared(history, model);
  const TwoApexes apexes(mesh, history, tx_end.part(), rx_end.part());
  const auto count = std::size_t(samples.count);
  ScatteringParameters scattering(model);
  std::vector<std::size_t> first_own;  // by parameter
  std::vector<PointVelocity> tx_velocities, rx_velocities;
  for (std::size_t n = 0; n < parameters.size(); ++n) {
    first_own.push_back(scattering.count);
    for (const MaterialParameter& own : parameters[n].by_scattering) scattering.add(own);
    tx_velocities.push_back([&tx_end, n](PointId id, glm::dvec3 at) { return tx_end.of_point(n, id, at); });
    rx_velocities.push_back([&rx_end, n](PointId id, glm::dvec3 at) { return rx_end.of_point(n, id, at); });
  }
  first_own.push_back(scattering.count);
  CornerVelocities tx(apexes.tx, tx_velocities), rx(apexes.rx, rx_velocities);
  std::vector<glm::dvec3> from, to;
  std::vector<std::vector<glm::dvec2>> of_from(parameters.size()), of_to(parameters.size());
  std::vector<double> factor;
  FacetId selected = no_facet;
  for_each_path(history, beams, samples, model, scattering, [&](const DifferentiatedPath& path) {
    const PathDerivatives& by = path.by;
    const bool other_facet = std::exchange(selected, path.facet.facet) != path.facet.facet;
    if (tx_end.select(path.tx_tube) || other_facet) tx.select(path.facet.facet);
    if (rx_end.select(path.rx_tube) || other_facet) rx.select(path.facet.facet);
    for (std::size_t n = 0; n < parameters.size(); ++n) {
      of_from[n].clear();
      of_to[n].clear();
    }
    for (const SharedEdge& edge : path.edges) {
      from = (edge.of_receiver ? rx : tx).of_corner(edge.from);
      to = (edge.of_receiver ? rx : tx).of_corner(edge.to);
      for (std::size_t n = 0; n < parameters.size(); ++n) {
        const glm::dvec3 of_apex = edge.of_receiver ? rx_end.of_end(n) - tx_end.of_end(n) : glm::dvec3(0);
        const glm::dvec2 of_frame = path.distance() * path.in_plane(tx.of_plane(n).normal);
        of_from[n].push_back(path.in_plane(of_apex + from[n]) + of_frame);
        of_to[n].push_back(path.in_plane(of_apex + to[n]) + of_frame);
      }
    }
    for (std::size_t n = 0; n < parameters.size(); ++n) {
      const EchoParameter& parameter = parameters[n];
      const CornerVelocities::UnitPlane plane = tx.of_plane(n);
      const glm::dvec3 of_apex = rx_end.of_end(n) - tx_end.of_end(n);
      const glm::dvec2 foot = path.in_plane(of_apex) + path.descent() * path.in_plane(plane.normal);
      factor.assign(by.count, 0);
      factor[Numbers::by_absorption] = path.scale * per_db * parameter.by_absorption;
      factor[Numbers::by_borders] = path.scale * parameter.by_range_scale;
      factor[Numbers::by_tx_distance] = path.scale * plane.distance;
      factor[Numbers::by_rx_distance] = path.scale * (plane.distance + glm::dot(plane.normal, apexes.rx_m) +
                                                      glm::dot(path.facet.plane.normal, of_apex));
      factor[Numbers::by_foot] = path.scale * foot.x;
      factor[Numbers::by_foot + 1] = path.scale * foot.y;
      if (by.texture > 0) {
        const glm::dvec2 tilt = path.scale * path.in_plane(plane.normal);
        factor[by.texture + Numbers::by_tilt] = tilt.x;
        factor[by.texture + Numbers::by_tilt + 1] = tilt.y;
        for (int k = 0; k < 3; ++k)
          factor[by.texture + Numbers::by_place + std::size_t(k)] =
              path.scale * (parameter.apex_velocity + tx_end.of_end(n))[k];
      }
      if (by.loss > 0) {
        // At fixed coordinates in the frame, a tilt of the frame turns the normals the opposite way.
        factor[by.loss + Numbers::by_roughness] = path.scale * parameter.by_roughness;
        double* by_normal = &factor[by.loss + Numbers::by_rough_normal];
        const glm::dvec3 turn = glm::cross(path.facet.plane.normal, plane.normal);
        for (const auto& [end, loss] :
             {std::pair(&tx_end, &model.path.tx.loss), {&rx_end, &model.path.back().loss}})
          for (std::size_t k = 0; k < loss->rough_normals.size(); ++k) {
            const glm::dvec3 of_normal =
                end->of_rough_normal(n, k) + glm::cross(loss->rough_normals[k], turn);
            for (int i = 0; i < 3; ++i) *by_normal++ = path.scale * of_normal[i];
          }
      }
      if (path.lambert && !parameter.by_mu.empty()) factor[Numbers::energy] = parameter.by_mu[path.material];
      const std::vector<std::size_t>& own = scattering.numbers[path.material];
      for (std::size_t k = 0; k < own.size(); ++k)
        if (own[k] >= first_own[n] && own[k] < first_own[n + 1]) factor[Numbers::own_parameters + k] = 1;
      double* row = &all[n][path.beam * count];
      for (const PathDerivatives::Part& part : by.parts)
        row[part.bin] += path.scale * (glm::dot(part.by_from, of_from[n][part.edge]) +
                                       glm::dot(part.by_to, of_to[n][part.edge]));
      const double* numbers = by.numbers.data();
      for (std::size_t bin = by.first_bin; bin < by.end_bin; ++bin, numbers += by.count)
        for (std::size_t k = 0; k < by.count; ++k) row[bin] += factor[k] * numbers[k];
    }
  });
}

EchoGradient echo_gradient(const FacetMesh& mesh, const BistaticHistory& history, const ReceiveBeams& beams,
                           const RangeSamples& samples, const EchoModel& model,
                           std::span<const double> weights, std::span<const MaterialParameter> scattering) {
  check_bistatic(history, model);
  check_weights(weights, beams, samples);
  EchoGradient gradient;
  gradient.by_material_mu.assign(model.material_mu.size(), 0);
  gradient.by_scattering.assign(scattering.size(), 0);
  ApexAdjoint tx(mesh, history.shared.transmit_rays.size()), rx(mesh, history.shared.receive_rays.size());
  add_echo_gradient(mesh, history, beams, samples, model, weights, scattering, tx, rx, gradient);
  gradient.by_receiver = rx.by_end;
  gradient.by_vertex = std::move(tx.by_vertex);
  for (std::size_t v = 0; v < gradient.by_vertex.size(); ++v) {
    gradient.by_vertex[v] += rx.by_vertex[v];
    gradient.by_receiver -= rx.by_vertex[v];
  }
  gradient.by_ray = std::move(tx.by_ray);
  gradient.by_receive_ray = std::move(rx.by_ray);
  return gradient;
}

void add_echo_gradient(const FacetMesh& mesh, const BistaticHistory& history, const ReceiveBeams& beams,
                       const RangeSamples& samples, const EchoModel& model, std::span<const double> weights,
                       std::span<const MaterialParameter> scattering, EndAdjoint& tx_end, EndAdjoint& rx_end,
                       EchoGradient& gradient) {
  using Numbers = PathDerivatives;
  check_shared(history, model);
  ScatteringParameters parameters(model);
  for (const MaterialParameter& parameter : scattering) parameters.add(parameter);
  const TwoApexes apexes(mesh, history, tx_end.part(), rx_end.part());
  CornerAdjoint tx(apexes.tx, [&](PointId id, glm::dvec3 by) { tx_end.add_point(id, by); }),
      rx(apexes.rx, [&](PointId id, glm::dvec3 by) { rx_end.add_point(id, by); });
  std::vector<double> sum;
  std::vector<glm::dvec2> by_from, by_to;
  for_each_path(history, beams, samples, model, parameters, [&](const DifferentiatedPath& path) {
    const PathDerivatives& by = path.by;
    const glm::dvec3 normal = path.facet.plane.normal;
    tx_end.select(path.tx_tube);
    rx_end.select(path.rx_tube);
    const double* weight = &weights[path.beam * std::size_t(samples.count)];
    sum.assign(by.count, 0);
    const double* numbers = by.numbers.data();
    for (std::size_t bin = by.first_bin; bin < by.end_bin; ++bin, numbers += by.count)
      for (std::size_t k = 0; k < by.count; ++k) sum[k] += weight[bin] * numbers[k];
    if (path.lambert) gradient.by_material_mu[path.material] += sum[Numbers::energy];
    for (std::size_t k = Numbers::by_absorption; k < by.count; ++k) sum[k] *= path.scale;
    gradient.by_absorption += per_db * sum[Numbers::by_absorption];
    gradient.by_range_scale += sum[Numbers::by_borders];
    const std::vector<std::size_t>& own = parameters.numbers[path.material];
    for (std::size_t k = 0; k < own.size(); ++k)
      gradient.by_scattering[own[k]] += sum[Numbers::own_parameters + k];
    by_from.assign(path.edges.size(), glm::dvec2(0));
    by_to.assign(path.edges.size(), glm::dvec2(0));
    for (const PathDerivatives::Part& part : by.parts) {
      by_from[part.edge] += path.scale * weight[part.bin] * part.by_from;
      by_to[part.edge] += path.scale * weight[part.bin] * part.by_to;
    }
    const glm::dvec3 by_foot = path.in_space({sum[Numbers::by_foot], sum[Numbers::by_foot + 1]});
    const double by_rx_distance = sum[Numbers::by_rx_distance];
    glm::dvec3 by_apart = by_foot + by_rx_distance * normal;  // by the vector between both ends
    glm::dvec3 by_normal = path.descent() * by_foot + by_rx_distance * apexes.rx_m;
    if (by.texture > 0) {
      const double* moved = &sum[by.texture];
      by_normal += path.in_space({moved[Numbers::by_tilt], moved[Numbers::by_tilt + 1]});
      const glm::dvec3 by_place = vector_of(moved + Numbers::by_place);
      gradient.by_apex += by_place;
      tx_end.add_end(by_place);
    }
    if (by.loss > 0) {
      gradient.by_roughness += sum[by.loss + Numbers::by_roughness];
      const double* moved = &sum[by.loss + Numbers::by_rough_normal];
      for (const auto& [end, loss] :
           {std::pair(&tx_end, &model.path.tx.loss), {&rx_end, &model.path.back().loss}})
        for (std::size_t k = 0; k < loss->rough_normals.size(); ++k, moved += 3) {
          const glm::dvec3 by_rough = vector_of(moved);
          end->add_rough_normal(k, by_rough);
          by_normal += glm::cross(glm::cross(by_rough, loss->rough_normals[k]), normal);
        }
    }
    for (std::size_t k = 0; k < path.edges.size(); ++k) {
      const SharedEdge& edge = path.edges[k];
      const glm::dvec3 of_from = path.in_space(by_from[k]), of_to = path.in_space(by_to[k]);
      by_normal += path.distance() * (of_from + of_to);
      CornerAdjoint& adjoint = edge.of_receiver ? rx : tx;
      adjoint.add_corner(edge.from, path.facet.facet, of_from);
      adjoint.add_corner(edge.to, path.facet.facet, of_to);
      if (edge.of_receiver) by_apart += of_from + of_to;
    }
    tx_end.add_end(-by_apart);
    rx_end.add_end(by_apart);
    tx.add_plane(path.facet.facet, by_normal, sum[Numbers::by_tx_distance] + by_rx_distance);
  });
}

}  // namespace tubefoot
