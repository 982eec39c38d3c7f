// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/surface/facet_flattening.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <unordered_map>

#include "engine/surface/grazing_sine.hpp"
#include "engine/water/apparent_map.hpp"
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

/// Flattens a triangle into a plane with a given metric. Sets `at` to the corners in this plane.
BistaticFacet flattened_facet(const Metric& metric, const glm::dvec3 (&from_t)[3],
                              const glm::dvec3 (&from_r)[3], const glm::dvec3 (&lies)[3],
                              glm::dvec2 (&at)[3]) {
  const Flat flat(metric);
  const Place t = flatten(from_t, metric), r = flatten(from_r, metric);
  at[0] = -t.foot;
  at[1] = glm::dvec2(flat.along, 0) - t.foot;
  at[2] = glm::dvec2(flat.across_x, flat.across_y) - t.foot;
  BistaticFacet facet;
  facet.transmit_distance_m = t.height;
  facet.receive_distance_m = r.height;
  facet.receive_foot_m = r.foot - t.foot;
  facet.to_plane = facet_map(from_t, {{at[0], 0}, {at[1], 0}, {at[2], 0}});
  facet.transmit_seen = plane_through(at, from_t);
  facet.receive_seen = plane_through(at, from_r);
  facet.lies = plane_through(at, lies);
  return facet;
}

/// Corners of a facet in the rotational order of the pieces, as the transmitter sees them and where they lie.
struct TransmitCorners {
  std::array<VertexId, 3> vertex;
  glm::dvec3 from_apex[3], lies[3];

  TransmitCorners(const FacetMesh& seabed, const SharedFacet& of, const ApparentEnd& end,
                  const WorldGrid& grid)
      : vertex(seabed.facets[of.facet]) {
    take(end, grid);
    if (glm::dot(glm::cross(from_apex[1] - from_apex[0], from_apex[2] - from_apex[0]), of.plane_normal) > 0) {
      std::swap(vertex[1], vertex[2]);
      take(end, grid);
    }
  }

 private:
  void take(const ApparentEnd& end, const WorldGrid& grid) {
    for (std::size_t k = 0; k < 3; ++k) {
      from_apex[k] = grid.to_metres(end.surface_mesh.refined.mesh.vertices[vertex[k]]) - end.water.apex_m();
      lies[k] = end.surface_mesh.truth[vertex[k]];
    }
  }
};

}  // namespace

FlattenedFacet flatten_between(const glm::dvec3 (&from_t)[3], const glm::dvec3 (&from_r)[3],
                               const glm::dvec3 (&lies)[3]) {
  const Metric a = metric_of(from_t), b = metric_of(from_r);
  const Metric mean{(a.first + b.first) / 2, (a.second + b.second) / 2, (a.product + b.product) / 2};
  FlattenedFacet flattened;
  glm::dvec2 at[3];
  flattened.facet = flattened_facet(mean, from_t, from_r, lies, at);
  BistaticFacet& facet = flattened.facet;
  flattened.normal = glm::cross(lies[1] - lies[0], lies[2] - lies[0]);
  const Flat flat(mean);
  const double area_ratio = glm::length(flattened.normal) / (flat.along * flat.across_y);
  for (std::size_t k = 0; k < 3; ++k) {
    const double there = std::hypot(glm::length(at[k]), facet.transmit_distance_m),
                 back = std::hypot(glm::length(at[k] - facet.receive_foot_m), facet.receive_distance_m);
    flattened.there_m[k] = there;
    flattened.back_m[k] = back;
    BistaticFacet::Corner& corner = facet.corners[k];
    corner.transmit_seen = facet.transmit_distance_m / there;
    corner.receive_seen = facet.receive_distance_m / back;
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
  const ApparentSurface& received_from = receive_end.surface_mesh;
  std::vector<BistaticFacet> bistatic;
  bistatic.reserve(shared.facets.size());
  Rays sent(transmit), received(receive);
  const glm::dvec3 receive_apex = receive.apex_m();  // a grid point, as the transmitter's
  for (const SharedFacet& of : shared.facets) {
    stop_if_wanted();
    const TransmitCorners corners(seabed, of, transmit_end, grid);
    glm::dvec3 from_r[3];
    for (std::size_t k = 0; k < 3; ++k)
      from_r[k] = grid.to_metres(received_from.refined.mesh.vertices[corners.vertex[k]]) - receive_apex;
    const FlattenedFacet flattened = flatten_between(corners.from_apex, from_r, corners.lies);
    BistaticFacet& facet = bistatic.emplace_back(flattened.facet);
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3& lies = corners.lies[k];
      const Eigenray &tx = sent.to(corners.vertex[k], lies), &rx = received.to(corners.vertex[k], lies);
      BistaticFacet::Corner& corner = facet.corners[k];
      corner.transmit_lies = grazing_sine(flattened.normal, transmit.arrival_direction(lies, tx));
      corner.receive_lies = grazing_sine(flattened.normal, receive.arrival_direction(lies, rx));
      corner.gain *=
          spreading(receive, tx, rx, lies, flattened.there_m[k], flattened.back_m[k], absorption_db_per_m);
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
    const TransmitCorners corners(seabed_, of, transmit_, grid_);
    glm::dvec3 from_r[2][3];
    Metric mean;
    double seen_by = 0;
    bool sees[2]{};
    for (std::size_t r = 0; r < 2; ++r) {
      sees[r] = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const Image& there = image(r, corners.vertex[k]);
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
    glm::dvec2 at[3];
    facet = flattened_facet(mean, corners.from_apex, from_r[receiver], corners.lies, at);
  }
  return all;
}

}  // namespace tubefoot
