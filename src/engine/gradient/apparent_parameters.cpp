// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/apparent_parameters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>

#include "engine/scattering/scattering_derivative.hpp"
#include "geometry/steps/stop.hpp"

// Differentiates apparent positions (apparent_motion.hpp) and facet_factor() by the parameters. Rays and
// slopes of vertices are computed when a visible polygon first needs them.
namespace tubefoot {
namespace {

constexpr double no_derivative = std::numeric_limits<double>::quiet_NaN(),
                 two_way_per_db = std::numbers::ln10 / 5;

/// Cross-section of a facet by the sine of the grazing angle, with its derivative by the sine.
struct SigmaSlope {
  double value = 0, by_sine = 0;
};
SigmaSlope sigma_slope(const ScatteringModel* model, double sine) {
  if (model == nullptr) return {sine * sine, 2 * sine};
  sine = std::min(sine, 1.0);
  if (!(sine > 0)) return {};
  const double cosine = std::sqrt((1 - sine) * (1 + sine));
  const CrossSectionSlopes slopes = slopes_of(*model, sine, cosine);
  return {slopes.value, slopes.by_log_sine / sine - (cosine > 0 ? slopes.by_incidence / cosine : 0)};
}

/// A vector with its velocity.
struct MovingVector {
  glm::dvec3 at{0}, by{0};
  friend MovingVector operator-(const MovingVector& a, const MovingVector& b) {
    return {a.at - b.at, a.by - b.by};
  }
  friend MovingVector operator+(const MovingVector& a, const MovingVector& b) {
    return {a.at + b.at, a.by + b.by};
  }
  MovingVector scaled(double s) const { return {s * at, s * by}; }
  double log_length_by() const { return glm::dot(at, by) / glm::dot(at, at); }
};

MovingVector normal_of_corners(const std::array<MovingVector, 3>& c) {
  const MovingVector a = c[1] - c[0], b = c[2] - c[0];
  return {glm::cross(a.at, b.at), glm::cross(a.by, b.at) + glm::cross(a.at, b.by)};
}

/// Sine of the grazing angle of a direction on a plane, and its velocity.
std::pair<double, double> moving_sine(const MovingVector& normal, const MovingVector& along) {
  const double lengths = glm::length(normal.at) * glm::length(along.at);
  if (!(lengths > 0)) return {0, 0};
  const double product = glm::dot(normal.at, along.at), sine = std::abs(product) / lengths,
               by = (glm::dot(normal.by, along.at) + glm::dot(normal.at, along.by)) / lengths;
  return {sine, (product < 0 ? -by : by) - sine * (normal.log_length_by() + along.log_length_by())};
}

/// A corner or the centre of a facet, as facet_factor() uses it.
struct FactorNode {
  double weight = 0, density_per_m4 = 0, log_density_by = 0;
  MovingVector arrival, seen;
};

/// The two integrals of facet_factor() with their derivatives. `own`: derivative of the scattering model.
struct FactorIntegrals {
  const ScatteringModel* model;
  const ScatteringDerivative* own;
  double absorption_db_per_m, absorption_by;
  double refracted = 0, refracted_by = 0, straight = 0, straight_by = 0;

  void add(const FactorNode& node, const MovingVector& lies, const MovingVector& seen) {
    const auto section = [&](const MovingVector& normal, const MovingVector& along) {
      const auto [sine, by] = moving_sine(normal, along);
      const SigmaSlope sigma = sigma_slope(model, sine);
      double more = 0;
      if (own != nullptr && sine > 0) {
        const double s = std::min(sine, 1.0);
        more = own->cross_section(s, std::sqrt((1 - s) * (1 + s)));
      }
      return std::pair(sigma.value, sigma.by_sine * by + more);
    };
    const auto [true_sigma, true_by] = section(lies, node.arrival);
    refracted += node.weight * true_sigma * node.density_per_m4;
    refracted_by += node.weight * node.density_per_m4 * (true_by + true_sigma * node.log_density_by);
    const auto [sigma, sigma_by] = section(seen, node.seen);
    const double r = glm::length(node.seen.at), log_r_by = node.seen.log_length_by(),
                 density = std::exp(-absorption_db_per_m * r * two_way_per_db) / (r * r * r * r),
                 log_density_by =
                     -4 * log_r_by - two_way_per_db * r * (absorption_db_per_m * log_r_by + absorption_by);
    straight += node.weight * sigma * density;
    straight_by += node.weight * density * (sigma_by + sigma * log_density_by);
  }
};

/// Rays and slopes of the vertices and centres of an apparent surface.
class ApparentVelocities {
 public:
  ApparentVelocities(std::span<const StratifiedParameter> parameters, const ApparentSurface& surface,
                     const ApparentMap& apparent_map, const WorldGrid& grid, const EchoModel& model)
      : parameters_(parameters.begin(), parameters.end()),
        surface_(surface),
        apparent_map_(apparent_map),
        grid_(grid),
        scattering_(model.scattering),
        material_(model.material),
        absorption_db_per_m_(model.absorption_db_per_m) {
    for (const StratifiedParameter& parameter : parameters_) {
      if (parameter.sound_speed_m_s.empty() && parameter.at_rest.by_absorption == 0) {
        change_of_.push_back(ApparentMotion::no_change);
        continue;
      }
      change_of_.push_back(changes_.size());
      changes_.push_back({parameter.sound_speed_m_s, parameter.at_rest.by_absorption});
    }
  }

  glm::dvec3 velocity(std::size_t parameter, VertexId vertex) {
    if (is_at_rest(parameter, vertex)) return glm::dvec3(0);
    const Node& node = at_vertex(vertex);
    if (!node.motion) return glm::dvec3(no_derivative);
    return motion_of(parameter, node, velocity_at(parameter, vertex)).at;
  }

  /// Relative change of the factor of a facet.
  double factor_change(std::size_t parameter, FacetId facet) {
    const FactorRule rule = surface_.factor_rule[facet];
    const StratifiedParameter& own = parameters_[parameter];
    const std::array<VertexId, 3>& vertices = surface_.refined.mesh.facets[facet];
    if (own_of(own, facet) == nullptr &&
        std::ranges::all_of(vertices, [&](VertexId v) { return is_at_rest(parameter, v); }))
      return 0;
    if (rule == FactorRule::branch) return no_derivative;
    std::array<MovingVector, 3> corners, seen;
    std::array<FactorNode, 3> nodes;
    glm::dvec3 middle_by(0);
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 by = velocity_at(parameter, vertices[k]);
      const Node& node = at_vertex(vertices[k]);
      if (!node.motion) return no_derivative;
      const ApparentMotion::Velocity motion = motion_of(parameter, node, by);
      corners[k] = {surface_.truth[vertices[k]], by};
      middle_by += by / 3.0;
      seen[k] = {grid_.to_metres(surface_.refined.mesh.vertices[vertices[k]]) - apparent_map_.apex_m(),
                 motion.at};
      nodes[k] = node_of(rule == FactorRule::corners ? 1.0 / 3 : 1.0 / 12, node, motion, seen[k]);
    }
    const MovingVector lies = normal_of_corners(corners), apparent = normal_of_corners(seen);
    FactorIntegrals integrals{scattering_.empty() ? nullptr : scattering_[material_[facet]].get(),
                              own_of(own, facet), absorption_db_per_m_, own.at_rest.by_absorption};
    for (const FactorNode& node : nodes) integrals.add(node, lies, apparent);
    if (rule == FactorRule::corners_and_centre) {
      const Node& centre = at_centre(facet, (corners[0].at + corners[1].at + corners[2].at) / 3.0);
      if (!centre.motion) return no_derivative;
      integrals.add(node_of(0.75, centre, motion_of(parameter, centre, middle_by),
                            (seen[0] + seen[1] + seen[2]).scaled(1.0 / 3)),
                    lies, apparent);
    }
    // The factor of a facet that is seen edge-on is 0.
    if (!(integrals.refracted > 0 && integrals.straight > 0)) return 0;
    return integrals.refracted_by / integrals.refracted - integrals.straight_by / integrals.straight +
           lies.log_length_by() - apparent.log_length_by();
  }

 private:
  struct Node {
    CornerReturn returned;
    std::optional<ApparentMotion> motion{};
  };

  static FactorNode node_of(double weight, const Node& node, const ApparentMotion::Velocity& motion,
                            const MovingVector& seen) {
    return {weight,
            node.returned.density_per_m4,
            motion.log_density,
            {node.returned.arrival, motion.arrival},
            seen};
  }

  const ScatteringDerivative* own_of(const StratifiedParameter& parameter, FacetId facet) const {
    for (const MaterialParameter& own : parameter.at_rest.by_scattering)
      if (own.material == material_[facet]) return &own.derivative;
    return nullptr;
  }

  /// Returns whether neither a vertex nor its ray changes.
  bool is_at_rest(std::size_t parameter, VertexId vertex) const {
    return change_of_[parameter] == ApparentMotion::no_change &&
           parameters_[parameter].at_rest.apex_velocity == glm::dvec3(0) &&
           velocity_at(parameter, vertex) == glm::dvec3(0);
  }

  /// Velocity of the true position in the local frame.
  glm::dvec3 velocity_at(std::size_t parameter, VertexId vertex) const {
    const EchoParameter& own = parameters_[parameter].at_rest;
    return own.apex_velocity + (own.velocity
                                    ? own.velocity(vertex, surface_.truth[vertex] - apparent_map_.apex_m())
                                    : glm::dvec3(0));
  }
  ApparentMotion::Velocity motion_of(std::size_t parameter, const Node& node, glm::dvec3 velocity) const {
    return node.motion->of(velocity, parameters_[parameter].at_rest.apex_velocity, change_of_[parameter]);
  }

  const Node& at_vertex(VertexId vertex) {
    const auto [entry, is_new] = vertices_.try_emplace(vertex);
    if (!is_new) return entry->second;
    stop_if_wanted();
    const std::optional<ApparentPoint> image = apparent_map_.apparent(surface_.truth[vertex]);
    // Further rays to a point have their own apparent vertices.
    constexpr double units = 2;
    if (image && glm::distance(image->at_m, grid_.to_metres(surface_.refined.mesh.vertices[vertex])) <=
                     units * grid_.unit_m())
      fill(entry->second, surface_.truth[vertex], *image);
    return entry->second;
  }
  const Node& at_centre(FacetId facet, glm::dvec3 at_m) {
    const auto [entry, is_new] = centres_.try_emplace(facet);
    if (!is_new) return entry->second;
    if (const std::optional<ApparentPoint> image = apparent_map_.apparent(at_m))
      fill(entry->second, at_m, *image);
    return entry->second;
  }
  void fill(Node& node, glm::dvec3 at_m, const ApparentPoint& image) const {
    node.returned = corner_return(apparent_map_, at_m, image, absorption_db_per_m_);
    node.motion.emplace(apparent_map_, at_m, image, changes_);
  }

  std::vector<StratifiedParameter> parameters_;
  std::vector<std::size_t> change_of_;  // by parameter
  std::vector<WaterChange> changes_;
  const ApparentSurface& surface_;
  ApparentMap apparent_map_;
  const WorldGrid& grid_;
  std::span<const std::shared_ptr<const ScatteringModel>> scattering_;
  std::span<const std::uint16_t> material_;
  double absorption_db_per_m_;
  std::unordered_map<VertexId, Node> vertices_;
  std::unordered_map<FacetId, Node> centres_;
};

}  // namespace

std::vector<EchoParameter> apparent_parameters(std::span<const StratifiedParameter> parameters,
                                               const ApparentSurface& surface,
                                               const ApparentMap& apparent_map, const WorldGrid& grid,
                                               const EchoModel& model) {
  const auto velocities =
      std::make_shared<ApparentVelocities>(parameters, surface, apparent_map, grid, model);
  std::vector<EchoParameter> result;
  for (std::size_t n = 0; n < parameters.size(); ++n) {
    const StratifiedParameter& own = parameters[n];
    EchoParameter& seen = result.emplace_back(own.at_rest);
    seen.turn.reset();
    const bool moves = own.at_rest.velocity || own.at_rest.apex_velocity != glm::dvec3(0);
    if (!own.sound_speed_m_s.empty() || moves)
      seen.velocity = [velocities, n, of_rays = own.at_rest.velocity](PointId id, glm::dvec3 at) {
        if (id & ray_bit) return of_rays ? of_rays(id, at) : glm::dvec3(0);
        return velocities->velocity(n, id);
      };
    if (seen.velocity || own.at_rest.by_absorption != 0 || !own.at_rest.by_scattering.empty())
      seen.by_facet_factor = [velocities, n](FacetId facet) { return velocities->factor_change(n, facet); };
  }
  return result;
}

}  // namespace tubefoot
