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

/// A change of a facet and of the water, per unit of a parameter. Velocities are those of true positions in
/// the local frame.
struct FacetChange {
  std::array<glm::dvec3, 3> corners{};
  glm::dvec3 apex{0};
  std::size_t water = ApparentMotion::no_change;
  double absorption_db_per_m = 0;
  const ScatteringDerivative* model = nullptr;

  bool none() const {
    return corners == std::array<glm::dvec3, 3>{} && apex == glm::dvec3(0) &&
           water == ApparentMotion::no_change && model == nullptr;
  }
};

/// Rays and slopes of the vertices and centres of an apparent surface.
class ApparentVelocities {
 public:
  /// Without `changes`, the changes are those of ApparentMotion::ByProfilePoint.
  ApparentVelocities(std::optional<std::vector<WaterChange>> changes, const ApparentSurface& surface,
                     const ApparentMap& apparent_map, const WorldGrid& grid, const EchoModel& model)
      : changes_(std::move(changes)),
        surface_(surface),
        apparent_map_(apparent_map),
        grid_(grid),
        scattering_(model.scattering),
        material_(model.material),
        absorption_db_per_m_(model.absorption_db_per_m) {}

  const ApparentMap& apparent_map() const { return apparent_map_; }
  const ApparentSurface& surface() const { return surface_; }
  std::uint16_t material(FacetId facet) const { return material_[facet]; }

  /// Velocity of an apparent vertex relative to the apex. `water`: number of a change.
  glm::dvec3 velocity(VertexId vertex, glm::dvec3 point, glm::dvec3 apex, std::size_t water) {
    if (point == glm::dvec3(0) && apex == glm::dvec3(0) && water == ApparentMotion::no_change)
      return glm::dvec3(0);
    const Node& node = at_vertex(vertex);
    return node.motion ? node.motion->of(point, apex, water).at : glm::dvec3(no_derivative);
  }

  /// Adds the numbers of the changes of the water on which a vertex depends.
  void add_changes_at(VertexId vertex, std::vector<std::size_t>& changes) { add(at_vertex(vertex), changes); }
  /// Returns the numbers of the changes of the water on which the factor of a facet depends.
  std::vector<std::size_t> changes_of(FacetId facet) {
    std::vector<std::size_t> changes;
    const std::array<VertexId, 3>& vertices = surface_.refined.mesh.facets[facet];
    for (const VertexId vertex : vertices) add_changes_at(vertex, changes);
    if (surface_.factor_rule[facet] == FactorRule::corners_and_centre)
      add(at_centre(facet, (surface_.truth[vertices[0]] + surface_.truth[vertices[1]] +
                            surface_.truth[vertices[2]]) /
                               3.0),
          changes);
    std::ranges::sort(changes);
    changes.erase(std::unique(changes.begin(), changes.end()), changes.end());
    return changes;
  }

  /// Relative change of the factor of a facet.
  double factor_change(FacetId facet, const FacetChange& change) {
    if (change.none()) return 0;
    const FactorRule rule = surface_.factor_rule[facet];
    if (rule == FactorRule::branch) return no_derivative;
    const std::array<VertexId, 3>& vertices = surface_.refined.mesh.facets[facet];
    std::array<MovingVector, 3> corners, seen;
    std::array<FactorNode, 3> nodes;
    for (std::size_t k = 0; k < 3; ++k) {
      const Node& node = at_vertex(vertices[k]);
      if (!node.motion) return no_derivative;
      const ApparentMotion::Velocity motion = node.motion->of(change.corners[k], change.apex, change.water);
      corners[k] = {surface_.truth[vertices[k]], change.corners[k]};
      seen[k] = {grid_.to_metres(surface_.refined.mesh.vertices[vertices[k]]) - apparent_map_.apex_m(),
                 motion.at};
      nodes[k] = node_of(rule == FactorRule::corners ? 1.0 / 3 : 1.0 / 12, node, motion, seen[k]);
    }
    const MovingVector lies = normal_of_corners(corners), apparent = normal_of_corners(seen);
    FactorIntegrals integrals{scattering_.empty() ? nullptr : scattering_[material_[facet]].get(),
                              change.model, absorption_db_per_m_, change.absorption_db_per_m};
    for (const FactorNode& node : nodes) integrals.add(node, lies, apparent);
    if (rule == FactorRule::corners_and_centre) {
      const MovingVector middle = (corners[0] + corners[1] + corners[2]).scaled(1.0 / 3);
      const Node& centre = at_centre(facet, middle.at);
      if (!centre.motion) return no_derivative;
      integrals.add(node_of(0.75, centre, centre.motion->of(middle.by, change.apex, change.water),
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

  static void add(const Node& node, std::vector<std::size_t>& changes) {
    if (node.motion)
      for (const auto& [change, values] : node.motion->effects()) changes.push_back(change);
  }

  static FactorNode node_of(double weight, const Node& node, const ApparentMotion::Velocity& motion,
                            const MovingVector& seen) {
    return {weight,
            node.returned.density_per_m4,
            motion.log_density,
            {node.returned.arrival, motion.arrival},
            seen};
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
    if (changes_)
      node.motion.emplace(apparent_map_, at_m, image, *changes_);
    else
      node.motion.emplace(apparent_map_, at_m, image, ApparentMotion::ByProfilePoint());
  }

  std::optional<std::vector<WaterChange>> changes_;
  const ApparentSurface& surface_;
  ApparentMap apparent_map_;
  const WorldGrid& grid_;
  std::span<const std::shared_ptr<const ScatteringModel>> scattering_;
  std::span<const std::uint16_t> material_;
  double absorption_db_per_m_;
  std::unordered_map<VertexId, Node> vertices_;
  std::unordered_map<FacetId, Node> centres_;
};

/// The effect of one parameter on an apparent surface.
struct ApparentEffect {
  std::shared_ptr<ApparentVelocities> velocities;
  EchoParameter at_rest;
  std::size_t water;

  /// Velocity of the true position in the local frame.
  glm::dvec3 velocity_of(VertexId vertex) const {
    return at_rest.apex_velocity + (at_rest.velocity
                                        ? at_rest.velocity(vertex, velocities->surface().truth[vertex] -
                                                                       velocities->apparent_map().apex_m())
                                        : glm::dvec3(0));
  }
  glm::dvec3 apparent_velocity(VertexId vertex) const {
    return velocities->velocity(vertex, velocity_of(vertex), at_rest.apex_velocity, water);
  }
  double factor_change(FacetId facet) const {
    FacetChange change;
    for (std::size_t k = 0; k < 3; ++k)
      change.corners[k] = velocity_of(velocities->surface().refined.mesh.facets[facet][k]);
    change.apex = at_rest.apex_velocity;
    change.water = water;
    change.absorption_db_per_m = at_rest.by_absorption;
    for (const MaterialParameter& own : at_rest.by_scattering)
      if (own.material == velocities->material(facet)) change.model = &own.derivative;
    return velocities->factor_change(facet, change);
  }
};

/// Computes each value of a function once, because many polygons have the same facets and vertices.
template <class Key, class Value, class Function>
auto computed_once(Function function) {
  return [function, known = std::make_shared<std::unordered_map<Key, Value>>()](Key key) {
    const auto [entry, is_new] = known->try_emplace(key);
    if (is_new) entry->second = function(key);
    return entry->second;
  };
}

}  // namespace

std::vector<EchoParameter> apparent_parameters(std::span<const StratifiedParameter> parameters,
                                               const ApparentSurface& surface,
                                               const ApparentMap& apparent_map, const WorldGrid& grid,
                                               const EchoModel& model) {
  std::vector<WaterChange> changes;
  std::vector<std::size_t> change_of;
  for (const StratifiedParameter& own : parameters) {
    const bool changes_water = !own.sound_speed_m_s.empty() || own.at_rest.by_absorption != 0;
    change_of.push_back(changes_water ? changes.size() : ApparentMotion::no_change);
    if (changes_water) changes.push_back({own.sound_speed_m_s, own.at_rest.by_absorption});
  }
  const auto velocities =
      std::make_shared<ApparentVelocities>(std::move(changes), surface, apparent_map, grid, model);
  std::vector<EchoParameter> result;
  for (std::size_t n = 0; n < parameters.size(); ++n) {
    const EchoParameter& at_rest = parameters[n].at_rest;
    const auto effect = std::make_shared<const ApparentEffect>(velocities, at_rest, change_of[n]);
    EchoParameter& seen = result.emplace_back(at_rest);
    seen.turn.reset();
    if (at_rest.velocity || at_rest.apex_velocity != glm::dvec3(0) || !parameters[n].sound_speed_m_s.empty())
      seen.velocity = [effect, of_vertex = computed_once<VertexId, glm::dvec3>([effect](VertexId vertex) {
                                 return effect->apparent_velocity(vertex);
                               })](PointId id, glm::dvec3 at) {
        if (id & ray_bit) return effect->at_rest.velocity ? effect->at_rest.velocity(id, at) : glm::dvec3(0);
        return of_vertex(id);
      };
    if (seen.velocity || at_rest.by_absorption != 0 || !at_rest.by_scattering.empty())
      seen.by_facet_factor =
          computed_once<FacetId, double>([effect](FacetId facet) { return effect->factor_change(facet); });
    if (at_rest.velocity || at_rest.apex_velocity != glm::dvec3(0))
      seen.true_velocity = [effect](VertexId vertex) { return effect->velocity_of(vertex); };
  }
  return result;
}

StratifiedGradient stratified_gradient(const EchoGradient& gradient, const ApparentSurface& surface,
                                       const ApparentMap& apparent_map, const WorldGrid& grid,
                                       const EchoModel& model,
                                       std::span<const MaterialParameter> scattering) {
  ApparentVelocities velocities(std::nullopt, surface, apparent_map, grid, model);
  const std::size_t absorption = apparent_map.water().profile.points().size();
  std::vector<std::size_t> changes;
  StratifiedGradient result;
  result.by_vertex = gradient.by_true_vertex;
  result.by_vertex.resize(surface.truth.size(), glm::dvec3(0));
  result.by_sound_speed.assign(absorption, 0);
  result.by_absorption = gradient.by_absorption;
  result.by_scattering = gradient.by_scattering;
  constexpr std::size_t none = ApparentMotion::no_change;
  constexpr glm::dvec3 still(0), axes[]{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (VertexId v = 0; v < gradient.by_vertex.size(); ++v) {
    const glm::dvec3 by = gradient.by_vertex[v];
    if (by == still) continue;
    for (int k = 0; k < 3; ++k) {
      result.by_vertex[v][k] += glm::dot(by, velocities.velocity(v, axes[k], still, none));
      result.by_apex[k] += glm::dot(by, velocities.velocity(v, still, axes[k], none));
    }
    changes.clear();
    velocities.add_changes_at(v, changes);
    for (const std::size_t n : changes)
      if (n != absorption) result.by_sound_speed[n] += glm::dot(by, velocities.velocity(v, still, still, n));
  }
  for (FacetId f = 0; f < gradient.by_facet_factor.size(); ++f) {
    const double by = gradient.by_facet_factor[f];
    if (by == 0) continue;
    const auto changed = [&](FacetChange change) { return by * velocities.factor_change(f, change); };
    for (int k = 0; k < 3; ++k) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        FacetChange change;
        change.corners[corner] = axes[k];
        result.by_vertex[surface.refined.mesh.facets[f][corner]][k] += changed(change);
      }
      result.by_apex[k] += changed({.apex = axes[k]});
    }
    for (const std::size_t n : velocities.changes_of(f))
      if (n != absorption) result.by_sound_speed[n] += changed({.water = n});
    result.by_absorption += changed({.water = absorption, .absorption_db_per_m = 1});
    for (std::size_t n = 0; n < scattering.size(); ++n)
      if (scattering[n].material == velocities.material(f))
        result.by_scattering[n] += changed({.model = &scattering[n].derivative});
  }
  return result;
}

}  // namespace tubefoot
