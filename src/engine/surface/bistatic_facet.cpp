// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/surface/bistatic_facet.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <unordered_map>

#include "engine/surface/grazing_sine.hpp"
#include "geometry/steps/stop.hpp"

// Flattens facets between two apexes in stratified water. The metric of the flat triangle is the mean of the
// metrics (squared edge lengths and their product) that the apexes see. The heights and foot points of the
// apexes follow from the apparent ranges of the corners. See docs/notes/bistatic.md.
namespace tubefoot {
namespace {

constexpr double least_sine = 1e-3;

/// Squared lengths of two edges from a corner, and their scalar product.
struct Metric {
  double first = 0, second = 0, product = 0;
};

Metric metric_of(const glm::dvec3 (&c)[3]) {
  const glm::dvec3 first = c[1] - c[0], second = c[2] - c[0];
  return {glm::dot(first, first), glm::dot(second, second), glm::dot(first, second)};
}

/// Triangle in its plane. The first corner is the origin, and the first edge lies along x.
struct Flat {
  double along, across_x, across_y;
  explicit Flat(const Metric& m)
      : along(std::sqrt(m.first)),
        across_x(m.product / along),
        across_y(std::sqrt(std::max(m.second - across_x * across_x, 0.0))) {}
  /// Foot point of a position, given by its scalar products with the two edges.
  glm::dvec2 foot(double with_first, double with_second) const {
    const double x = with_first / along;
    return {x, across_y > 0 ? (with_second - x * across_x) / across_y : 0};
  }
};

struct Place {
  glm::dvec2 foot;
  double height;
};

/// Position of an apex that sees the corners `seen` (relative to the apex), over a triangle with another
/// metric.
Place flatten(const glm::dvec3 (&seen)[3], const Metric& metric) {
  const Metric own = metric_of(seen);
  const double first = -glm::dot(seen[0], seen[1] - seen[0]), second = -glm::dot(seen[0], seen[2] - seen[0]);
  const glm::dvec2 foot =
      Flat(metric).foot(first + (metric.first - own.first) / 2, second + (metric.second - own.second) / 2);
  // The height is the apparent height, corrected by the displacement of the foot point. If the foot point
  // does not move, this form loses no digits.
  const glm::dvec2 seen_foot = Flat(own).foot(first, second);
  const glm::dvec3 normal = glm::cross(seen[1] - seen[0], seen[2] - seen[0]);
  const double height = glm::dot(normal, seen[0]) / glm::length(normal),
               height2 = height * height + (glm::dot(seen_foot, seen_foot) - glm::dot(foot, foot)),
               least = least_sine * glm::length(seen[0]);
  return {foot, std::sqrt(std::max(height2, least * least))};
}

/// Affine map of a plane that takes three of its points to three positions.
LyingPlane plane_through(const glm::dvec2 (&at)[3], const glm::dvec3 (&places)[3]) {
  const FacetMap map = facet_map({{at[0], 0}, {at[1], 0}, {at[2], 0}}, places);
  LyingPlane plane;
  plane.foot_m = map.at(glm::dvec3(0));
  plane.u = map.linear[0];
  plane.v = map.linear[1];
  return plane;
}

/// Rays to true vertices. Each ray is computed once.
class Rays {
 public:
  explicit Rays(const ApparentMap& water) : water_(water) {}
  const Eigenray& to(VertexId vertex, const glm::dvec3& at_m) {
    const auto known = known_.find(vertex);
    if (known != known_.end()) return known->second;
    const auto found = water_.apparent(at_m);
    return known_.emplace(vertex, found ? found->ray : Eigenray{}).first->second;
  }

 private:
  const ApparentMap& water_;
  std::unordered_map<VertexId, Eigenray> known_;
};

/// Return of a corner without scattering and area, relative to the straight-ray return. It contains the
/// ray-tube area from the transmitter to the corner, the ray-tube area from the corner back to the receiver,
/// and the absorption.
double spreading(const ApparentMap& receive, const Eigenray& sent, const Eigenray& received,
                 const glm::dvec3& at_m, double there_m, double back_m, double absorption_db_per_m) {
  const double beyond_db =
      sent.absorption_db + received.absorption_db - absorption_db_per_m * (there_m + back_m);
  return there_m * there_m / sent.tube_area_m2_per_sr * (back_m * back_m) /
         receive.return_area_m2_per_sr(at_m, received) * std::exp(-beyond_db * std::numbers::ln10 / 10);
}

}  // namespace

FlattenedFacet flatten_between(const glm::dvec3 (&from_t)[3], const glm::dvec3 (&from_r)[3],
                               const glm::dvec3 (&lies)[3]) {
  const Metric a = metric_of(from_t), b = metric_of(from_r);
  const Metric mean{(a.first + b.first) / 2, (a.second + b.second) / 2, (a.product + b.product) / 2};
  const Flat flat(mean);
  const Place t = flatten(from_t, mean), r = flatten(from_r, mean);
  const glm::dvec2 at[3]{-t.foot, glm::dvec2(flat.along, 0) - t.foot,
                         glm::dvec2(flat.across_x, flat.across_y) - t.foot};
  FlattenedFacet flattened;
  BistaticFacet& facet = flattened.facet;
  facet.transmit_distance_m = t.height;
  facet.receive_distance_m = r.height;
  facet.receive_foot_m = r.foot - t.foot;
  facet.to_plane = facet_map(from_t, {{at[0], 0}, {at[1], 0}, {at[2], 0}});
  facet.transmit_seen = plane_through(at, from_t);
  facet.receive_seen = plane_through(at, from_r);
  facet.lies = plane_through(at, lies);
  flattened.normal = glm::cross(lies[1] - lies[0], lies[2] - lies[0]);
  const double area_ratio = glm::length(flattened.normal) / (flat.along * flat.across_y);
  for (std::size_t k = 0; k < 3; ++k) {
    const double there = std::hypot(glm::length(at[k]), t.height),
                 back = std::hypot(glm::length(at[k] - facet.receive_foot_m), r.height);
    flattened.there_m[k] = there;
    flattened.back_m[k] = back;
    BistaticFacet::Corner& corner = facet.corners[k];
    corner.transmit_seen = t.height / there;
    corner.receive_seen = r.height / back;
    corner.gain = area_ratio;
    facet.misfit_m = std::max(facet.misfit_m,
                              std::abs(there - glm::length(from_t[k]) + back - glm::length(from_r[k])) / 2);
  }
  return flattened;
}

std::vector<BistaticFacet> bistatic_facets(const SharedFootprints& shared, const ApparentPair& pair,
                                           const WorldGrid& grid, const ApparentMap& transmit,
                                           const ApparentMap& receive, double absorption_db_per_m) {
  return bistatic_facets(shared, pair.mesh, {pair.transmit, transmit}, {pair.receive, receive}, grid,
                         absorption_db_per_m);
}

std::vector<BistaticFacet> bistatic_facets(const SharedFootprints& shared, const FacetMesh& seabed,
                                           const ApparentEnd& transmit_end, const ApparentEnd& receive_end,
                                           const WorldGrid& grid, double absorption_db_per_m) {
  const ApparentMap &transmit = transmit_end.water, &receive = receive_end.water;
  const ApparentSurface &sent_to = transmit_end.surface_mesh, &received_from = receive_end.surface_mesh;
  std::vector<BistaticFacet> bistatic;
  bistatic.reserve(shared.facets.size());
  Rays sent(transmit), received(receive);
  // Apexes are grid points.
  const glm::dvec3 transmit_apex = transmit.apex_m(), receive_apex = receive.apex_m();
  for (const SharedFacet& of : shared.facets) {
    stop_if_wanted();
    std::array<VertexId, 3> vertex = seabed.facets[of.facet];
    glm::dvec3 from_t[3], from_r[3], lies[3];
    const auto take = [&] {
      for (std::size_t k = 0; k < 3; ++k) {
        from_t[k] = grid.to_metres(sent_to.refined.mesh.vertices[vertex[k]]) - transmit_apex;
        from_r[k] = grid.to_metres(received_from.refined.mesh.vertices[vertex[k]]) - receive_apex;
        lies[k] = sent_to.truth[vertex[k]];
      }
    };
    take();
    // Corners are in the rotational order of the pieces.
    if (glm::dot(glm::cross(from_t[1] - from_t[0], from_t[2] - from_t[0]), of.plane_normal) > 0) {
      std::swap(vertex[1], vertex[2]);
      take();
    }
    const FlattenedFacet flattened = flatten_between(from_t, from_r, lies);
    BistaticFacet& facet = bistatic.emplace_back(flattened.facet);
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigenray &tx = sent.to(vertex[k], lies[k]), &rx = received.to(vertex[k], lies[k]);
      BistaticFacet::Corner& corner = facet.corners[k];
      corner.transmit_lies = grazing_sine(flattened.normal, transmit.arrival_direction(lies[k], tx));
      corner.receive_lies = grazing_sine(flattened.normal, receive.arrival_direction(lies[k], rx));
      corner.gain *=
          spreading(receive, tx, rx, lies[k], flattened.there_m[k], flattened.back_m[k], absorption_db_per_m);
    }
  }
  return bistatic;
}

ReceiverPairFlattening::ReceiverPairFlattening(const FacetMesh& seabed, const ApparentEnd& transmit,
                                               const std::array<const ApparentMap*, 2>& receivers,
                                               const WorldGrid& grid)
    : seabed_(seabed), transmit_(transmit), receivers_(receivers), grid_(grid) {}

const ReceiverPairFlattening::Image& ReceiverPairFlattening::image(std::size_t receiver, VertexId vertex) {
  const auto known = images_[receiver].find(vertex);
  if (known != images_[receiver].end()) return known->second;
  const ApparentMap& water = *receivers_[receiver];
  const auto found = water.apparent(grid_.to_metres(seabed_.vertices[vertex]));
  return images_[receiver]
      .emplace(vertex, found ? Image(found->at_m - water.apex_m()) : Image())
      .first->second;
}

std::vector<BistaticFacet> ReceiverPairFlattening::of(const SharedFootprints& shared, std::size_t receiver) {
  std::vector<BistaticFacet> all;
  all.reserve(shared.facets.size());
  for (const SharedFacet& of : shared.facets) {
    stop_if_wanted();
    std::array<VertexId, 3> vertex = seabed_.facets[of.facet];
    glm::dvec3 from_t[3], lies[3], from_r[2][3];
    const auto take = [&] {
      for (std::size_t k = 0; k < 3; ++k) {
        from_t[k] = grid_.to_metres(transmit_.surface_mesh.refined.mesh.vertices[vertex[k]]) -
                    transmit_.water.apex_m();
        lies[k] = transmit_.surface_mesh.truth[vertex[k]];
      }
    };
    take();
    // Corners are in the rotational order of the pieces.
    if (glm::dot(glm::cross(from_t[1] - from_t[0], from_t[2] - from_t[0]), of.plane_normal) > 0) {
      std::swap(vertex[1], vertex[2]);
      take();
    }
    Metric mean;
    double seen_by = 0;
    bool sees[2]{};
    for (std::size_t r = 0; r < 2; ++r) {
      sees[r] = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const Image& there = image(r, vertex[k]);
        sees[r] = sees[r] && there;
        if (there) from_r[r][k] = *there;
      }
      if (!sees[r]) continue;
      const Metric own = metric_of(from_r[r]);
      mean = {mean.first + own.first, mean.second + own.second, mean.product + own.product};
      ++seen_by;
    }
    BistaticFacet& facet = all.emplace_back();
    if (!sees[receiver]) continue;
    mean = {mean.first / seen_by, mean.second / seen_by, mean.product / seen_by};
    const Flat flat(mean);
    const Place t = flatten(from_t, mean), r = flatten(from_r[receiver], mean);
    const glm::dvec2 at[3]{-t.foot, glm::dvec2(flat.along, 0) - t.foot,
                           glm::dvec2(flat.across_x, flat.across_y) - t.foot};
    facet.transmit_distance_m = t.height;
    facet.receive_distance_m = r.height;
    facet.receive_foot_m = r.foot - t.foot;
    facet.to_plane = facet_map(from_t, {{at[0], 0}, {at[1], 0}, {at[2], 0}});
    facet.transmit_seen = plane_through(at, from_t);
    facet.receive_seen = plane_through(at, from_r[receiver]);
    facet.lies = plane_through(at, lies);
  }
  return all;
}

// The distance of the middle from the plane's point p is sqrt(D^2 + |p - F|^2). Its apparent position s(p)
// is linear in p. The distance of the end is the root of D^2 + |p - F|^2 - 2 by . s(p) + by^2. This is again
// a distance and a foot point.
bool BistaticFacet::move_receiver(glm::dvec3 by_m) {
  const LyingPlane& seen = receive_seen;
  const glm::dvec2 from = receive_foot_m,
                   foot = from + glm::dvec2(glm::dot(by_m, seen.u), glm::dot(by_m, seen.v));
  const double distance2 = receive_distance_m * receive_distance_m + glm::dot(from, from) -
                           glm::dot(foot, foot) + glm::dot(by_m, by_m) - 2 * glm::dot(by_m, seen.foot_m);
  if (!(distance2 > 0)) return false;
  receive_distance_m = std::sqrt(distance2);
  receive_foot_m = foot;
  receive_seen.foot_m -= by_m;
  return true;
}

double bistatic_factor(const BistaticFacet& facet, const ScatteringModel* model) {
  const auto sigma = [model](double sine) {
    if (model == nullptr) return sine * sine;
    sine = std::min(sine, 1.0);
    return model->cross_section(sine, std::sqrt((1 - sine) * (1 + sine)));
  };
  double sum = 0;
  for (const BistaticFacet::Corner& c : facet.corners) {
    const double seen = sigma(c.transmit_seen) * sigma(c.receive_seen);
    if (seen > 0 && std::isfinite(c.gain))
      sum += c.gain * std::sqrt(sigma(c.transmit_lies) * sigma(c.receive_lies) / seen);
  }
  return sum / 3;
}

}  // namespace tubefoot
