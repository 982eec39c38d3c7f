// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/certified_gradient.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>

#include "engine/certified/certified_driver.hpp"
#include "engine/certified/certified_integral.hpp"
#include "engine/gradient/certified_edges.hpp"
#include "engine/gradient/named_vectors.hpp"
#include "geometry/numbers/ball_vector.hpp"
#include "geometry/numbers/scalars.hpp"

// Encloses derivatives polygon by polygon: integrals along edges (certified_edges.hpp) times velocities of
// corners (named_vectors.hpp). The integrators of the reference enclose energies and their derivatives by
// the absorption.

namespace tubefoot {
namespace {

/// Tolerances of energies, relative to the energy of a part.
constexpr double energy_tolerance = 1e-16;

void check_certified(const History& history, const EchoModel& model) {
  check(model);
  const auto reject_certified = [](const std::string& what) {
    throw std::invalid_argument("certified gradient: " + what);
  };
  const FootprintSet& set = history.footprints;
  if (set.corner_names.size() != set.corners_m.size())
    reject_certified("the footprints have no names of corners: set VisibilityOptions::corner_names");
  if (!history.hits.empty()) reject_certified("hits of rays have no borders: use the tube engine");
  if (model.patterns != nullptr || !model.reflectivity.empty() || !model.scattering.empty() ||
      model.path.over_mirrors() || model.path.rx || !model.path.facet_factor.empty())
    reject_certified("only Lambert's law without patterns, textures, mirrors and refraction is supported");
}

/// The velocity of a point by a parameter. A relative change s of range borders is replaced by a change -s of
/// all lengths and s of the absorption. Energies then scale by (1 + s)^-2. In grid units for vertices, and in
/// units of their integers for rays.
BallVector velocity_of(const EchoParameter& parameter, const NamedPoints& points, double unit_m, PointId id) {
  const glm::dvec3 at = points.point(id);
  BallVector v;
  if (parameter.turn) {
    if (parameter.turn->moves(id))
      v = cross(balls(parameter.turn->axis), vector_between(parameter.turn->origin_m, at));
  } else if (parameter.velocity) {
    v = balls(parameter.velocity(id, at));
  }
  if (id & ray_bit) return v;
  for (int k = 0; k < 3; ++k) {
    Ball& x = v[std::size_t(k)];
    x = (x - Ball(parameter.by_range_scale) * Ball(at[k])) / Ball(unit_m);
  }
  return v;
}

/// One visible polygon for a Lambert parameter of 1. Energies and their derivatives by the absorption per
/// metre are by range bin.
struct CertifiedParts {
  std::map<std::size_t, Ball> energy, by_beta;
  std::vector<CertifiedEdges::Part> edges;
};

class CertifiedPolygons {
 public:
  CertifiedPolygons(const std::vector<double>& borders, const Ball& beta, bool needs_absorption)
      : needs_absorption_(needs_absorption), integrator_(borders, beta), edges_(borders, beta) {}

  CertifiedParts parts_of(const CertifiedPolygon& polygon) {
    CertifiedParts parts;
    const Ball square = squared(polygon.distance);
    edges_.add(polygon, [&](const CertifiedEdges::Part& part) { parts.edges.push_back(part); });
    integrate(polygon, nullptr, square, parts.energy);
    // The range times Lambert's density is the density of a cross-section of the sine of the grazing angle,
    // times the distance.
    static const ScatteringModel sine = ScatteringModel::gsab({.oblique = 1, .oblique_exponent = 1});
    if (needs_absorption_) integrate(polygon, &sine, Ball(-2) * polygon.distance, parts.by_beta);
    return parts;
  }

 private:
  void integrate(const CertifiedPolygon& polygon, const ScatteringModel* model, const Ball& factor,
                 std::map<std::size_t, Ball>& bins) {
    static const CertifiedIntegrator::Allowance allowance{
        energy_tolerance, [](std::uint32_t, std::uint32_t) { return least_allowed; }};
    integrator_.take_model(model);
    integrator_.add(polygon, 0, allowance,
                    [&](const Part<Ball>& part) { bins[part.sample] += factor * part.value; });
  }

  bool needs_absorption_;
  CertifiedIntegrator integrator_;
  CertifiedEdges edges_;
};

/// Derivatives of the motion of a polygon's plane and corners.
struct PolygonMotion {
  using Vectors = NamedVectors<MovingBall>;
  Ball distance;                             ///< in metres
  std::vector<std::array<Ball, 2>> corners;  ///< in the plane, in metres from the foot point

  PolygonMotion(Vectors& vectors, const CertifiedPolygon& polygon, std::span<const CornerName> corner_names,
                FacetId facet, double unit_m) {
    const Vectors::Plane& plane = vectors.plane(facet);
    const MovingBall length = root(dot(plane.normal, plane.normal)), apart = plane.offset / length;
    distance = apart.by * Ball(unit_m);
    for (const CornerName& name : corner_names) {
      const Vectors::Vector ray = vectors.ray(name);
      const MovingBall scale = plane.offset / dot(plane.normal, ray);
      BallVector moved;
      for (std::size_t k = 0; k < 3; ++k)
        moved[k] = ((scale * ray[k]).by - apart.at * (plane.normal[k] / length).by) * Ball(unit_m);
      corners.push_back({dot(moved, polygon.u), dot(moved, polygon.v)});
    }
  }
};

}  // namespace

CertifiedDerivatives certified_derivatives(const FacetMesh& mesh, const History& history,
                                           const ReceiveBeams& beams, const RangeSamples& samples,
                                           const EchoModel& model,
                                           std::span<const EchoParameter> parameters) {
  check_certified(history, model);
  const FootprintSet& set = history.footprints;
  const NameContext context{mesh, history.tubes.apex, set.name_rays};
  const NamedPoints points(context, history.grid_unit_m);
  const CertifiedRequest request(model, samples);
  const Ball per_db = log(Ball(10)) / Ball(10);
  const std::size_t row = request.row(), bins = std::size_t(beams.count) * row;
  std::vector<Ball> by_absorption;
  bool needs_absorption = false;
  for (const EchoParameter& parameter : parameters) {
    if (!parameter.by_scattering.empty())
      throw std::invalid_argument("certified gradient: parameters of scattering models are not supported");
    by_absorption.push_back(per_db * (Ball(parameter.by_absorption) +
                                      Ball(parameter.by_range_scale) * Ball(model.absorption_db_per_m)));
    needs_absorption = needs_absorption || !by_absorption.back().may_be_zero();
  }
  const auto enclose = [&](std::size_t item, Bins<Ball>& sums) {
    const Footprint& footprint = set.footprints[item];
    const Ball mu(model.seabed(footprint.facet).mu);
    const std::size_t first_bin = beams.of_tube[footprint.tube] * row;
    CertifiedPolygons polygons(request.borders, request.beta_per_m, needs_absorption);
    std::vector<std::optional<PolygonMotion::Vectors>> moving(parameters.size());
    for (std::size_t n = 0; n < parameters.size(); ++n)
      if (parameters[n].velocity || parameters[n].by_range_scale != 0)
        moving[n].emplace(context, [&, n](PointId id) {
          const GridPoint at = context.point(id);
          const BallVector by = velocity_of(parameters[n], points, history.grid_unit_m, id);
          return PolygonMotion::Vectors::Vector{MovingBall{Ball(at.x), by[0]}, MovingBall{Ball(at.y), by[1]},
                                                MovingBall{Ball(at.z), by[2]}};
        });
    for (std::uint32_t p = 0; p < footprint.piece_count; ++p) {
      stop_if_wanted();
      const Piece& piece = set.pieces[footprint.first_piece + p];
      const CertifiedPolygon polygon = certified_polygon(
          context, set.corner_names, {footprint.facet, piece.first, piece.count}, history.grid_unit_m);
      const CertifiedParts parts = polygons.parts_of(polygon);
      const Ball factor = mu * squared(polygon.distance);
      for (std::size_t n = 0; n < parameters.size(); ++n) {
        const EchoParameter& parameter = parameters[n];
        const auto at = [&](std::size_t sample) -> Ball& { return sums[n * bins + first_bin + sample]; };
        Ball by_energy = Ball(-2) * mu * Ball(parameter.by_range_scale);
        if (!parameter.by_mu.empty()) by_energy += Ball(parameter.by_mu[model.material[footprint.facet]]);
        if (moving[n]) {
          const PolygonMotion motion(*moving[n], polygon,
                                     std::span(set.corner_names).subspan(piece.first, piece.count),
                                     footprint.facet, history.grid_unit_m);
          by_energy += Ball(2) * mu * motion.distance / polygon.distance;
          for (const CertifiedEdges::Part& part : parts.edges) {
            const auto &first = motion.corners[part.edge],
                       &second = motion.corners[(part.edge + 1) % piece.count];
            Ball sum = part.by_distance * motion.distance;
            for (std::size_t k = 0; k < 2; ++k)
              sum += part.by_first[k] * first[k] + part.by_second[k] * second[k];
            at(part.bin) += factor * sum;
          }
        }
        for (const auto& [sample, energy] : parts.energy) at(sample) += by_energy * energy;
        for (const auto& [sample, by_beta] : parts.by_beta) at(sample) += mu * by_absorption[n] * by_beta;
      }
    }
  };
  const auto by_task =
      enclose_tasks("footprints", set.footprints.size(), facets_in_run, Bins<Ball>(), enclose);
  std::vector<Ball> total(parameters.size() * bins);
  for (const Bins<Ball>& sums : by_task)
    for (const auto& [bin, part] : sums) total[bin] += part;
  CertifiedDerivatives result;
  for (std::size_t n = 0; n < parameters.size(); ++n) {
    std::vector<double>&value = result.value.emplace_back(bins), &bound = result.bound.emplace_back(bins);
    for (std::size_t k = 0; k < bins; ++k) {
      const Ball& derivative = total[n * bins + k];
      value[k] = derivative.is_finite() ? derivative.middle() : 0;
      bound[k] = derivative.is_finite() ? radius_about(derivative, value[k]) : infinite;
    }
  }
  return result;
}

}  // namespace tubefoot
