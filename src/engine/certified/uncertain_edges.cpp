// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/uncertain_edges.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/numbers/enclosure_slack.hpp"
#include "geometry/steps/stop.hpp"

// Bounds ambiguous energies along occluding edges, along walls of tubes, and between facets that are closer
// together than their range errors. Each bound is an energy per steradian times an upper bound of a solid
// angle.
namespace tubefoot {
namespace {

using Polygon = std::vector<glm::dvec3>;
using State = FacetEnclosure::State;

std::uint64_t key_of(VertexId a, VertexId b) { return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b); }

/// Returns the part of a polygon on the inner side of a plane through the apex, or slightly beyond.
Polygon clipped(const Polygon& polygon, const glm::dvec3& inward) {
  Polygon kept;
  const double size = glm::length(inward);
  const auto height = [&](const glm::dvec3& p) {
    return glm::dot(inward, p) + 1e-12 * size * glm::length(p);
  };
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const glm::dvec3 &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    const double at_p = height(p), at_q = height(q);
    if (at_p >= 0) kept.push_back(p);
    if ((at_p >= 0) != (at_q >= 0)) kept.push_back(p + at_p / (at_p - at_q) * (q - p));
  }
  return kept;
}

/// Upper bound of the solid angle of a polygon, as seen from the apex.
double solid_angle_of(const Polygon& polygon) {
  double sum = 0;
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const glm::dvec3 a = glm::normalize(polygon[0]), b = glm::normalize(polygon[k - 1]),
                     c = glm::normalize(polygon[k]);
    sum += std::abs(
        2 * std::atan2(glm::dot(a, glm::cross(b, c)), 1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a)));
  }
  return sum * (1 + 1e-6) + 1e-15;
}

/// Range interval of a polygon on a plane at a given distance.
std::pair<double, double> ranges_of(const Polygon& polygon, double plane_m) {
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0, turn = 0;
  const glm::dvec3 first = glm::normalize(polygon.front());
  for (const glm::dvec3& p : polygon) {
    nearest = std::min(nearest, glm::length(p));
    farthest = std::max(farthest, glm::length(p));
    turn = std::max(turn, glm::distance(first, glm::normalize(p)));
  }
  // Between corners at most 2 `turn` apart, the range to a plane is at least the ranges of the corners times
  // the cosine.
  return {std::max(plane_m, nearest * (1 - std::min(2 * turn * turn, 1.0))) * (1 - enclosure_slack),
          farthest * (1 + enclosure_slack)};
}

/// Returns the cone around the apparent position of a facet.
Cone cone_of(std::span<const glm::dvec3> corners) {
  glm::dvec3 sum(0);
  for (const glm::dvec3& p : corners) sum += glm::normalize(p);
  Cone cone{glm::normalize(sum), 0};
  for (const glm::dvec3& p : corners)
    cone.spread_rad =
        std::max(cone.spread_rad, std::acos(std::clamp(glm::dot(cone.axis, glm::normalize(p)), -1.0, 1.0)));
  cone.spread_rad += 1e-7;
  return cone;
}
/// A chord is never longer than its angle.
bool may_meet(const Cone& a, const Cone& b, double beyond_rad) {
  const glm::dvec3 between = a.axis - b.axis;
  const double apart = a.spread_rad + b.spread_rad + beyond_rad;
  return glm::dot(between, between) <= apart * apart * (1 + enclosure_slack);
}

/// Largest angle between an image and its apparent facet.
double beyond_rad(const FacetEnclosure& facet) {
  return facet.travel_path_error_m / facet.nearest_m * 1.1 + enclosure_slack;
}

}  // namespace

AmbiguousPiece seen_piece(const NamedPiece& piece, const CertifiedPolygon& polygon) {
  AmbiguousPiece seen{piece.facet, {}};
  const auto vector = [](const std::array<Ball, 3>& v) {
    return glm::dvec3(v[0].middle(), v[1].middle(), v[2].middle());
  };
  const glm::dvec3 foot = polygon.distance.middle() * vector(polygon.away), u = vector(polygon.u),
                   v = vector(polygon.v);
  for (const CertifiedPolygon::Point& p : polygon.points)
    seen.corners_m.push_back(foot + p.x.middle() * u + p.y.middle() * v);
  return seen;
}

UncertainEdges::UncertainEdges(const FacetMesh& apparent, std::span<const FacetId> parent,
                               const ApparentEnclosures& enclosures, AmbiguitiesOf of)
    : mesh_(apparent), parent_(parent), enclosures_(enclosures), of_(of), cones_(apparent.facets.size()) {
  for (FacetId f = 0; f < mesh_.facets.size(); ++f) {
    const FacetEnclosure& facet = enclosures_.facets[f];
    if (facet.state == State::proven) cones_[f] = cone_of(facet.seen);
    for (std::size_t k = 0; k < 3; ++k) {
      EdgeOf& edge = edges_[key_of(mesh_.facets[f][k], mesh_.facets[f][(k + 1) % 3])];
      if (edge.count < 2) edge.facet[edge.count] = f;
      ++edge.count;
      edge.widest_rad = std::max(edge.widest_rad, facet.travel_path_error_m / facet.nearest_m);
    }
  }
}

UncertainEdges::Nearby UncertainEdges::nearby_of(std::span<const FacetId> facets) const {
  Nearby nearby;
  glm::dvec3 least(2), most(-2);
  for (const FacetId f : facets) {
    if (enclosures_.facets[f].state != State::proven) continue;
    nearby.facets.push_back(f);
    least = glm::min(least, cones_[f].axis);
    most = glm::max(most, cones_[f].axis);
    nearby.widest_rad = std::max(nearby.widest_rad, cones_[f].spread_rad + beyond_rad(enclosures_.facets[f]));
  }
  const glm::dvec3 size = most - least;
  for (int i = 1; i < 3; ++i)
    if (size[i] > size[nearby.coordinate]) nearby.coordinate = i;
  std::ranges::sort(nearby.facets, {},
                    [&](FacetId f) { return std::pair(cones_[f].axis[nearby.coordinate], f); });
  for (const FacetId f : nearby.facets) nearby.place.push_back(cones_[f].axis[nearby.coordinate]);
  return nearby;
}

template <class Take>
void UncertainEdges::each_within(const Nearby& nearby, const Cone& cone, const Take& take) const {
  const double apart = (cone.spread_rad + nearby.widest_rad) * (1 + enclosure_slack) + enclosure_slack,
               place = cone.axis[nearby.coordinate];
  const auto first = std::lower_bound(nearby.place.begin(), nearby.place.end(), place - apart);
  for (auto at = first; at != nearby.place.end() && *at <= place + apart; ++at) {
    const FacetId f = nearby.facets[std::size_t(at - nearby.place.begin())];
    if (may_meet(cone, cones_[f], beyond_rad(enclosures_.facets[f]))) take(f);
  }
}

/// An edge is smooth inside a base facet that is seen entirely from one side, because its image continues
/// across the edge. For points, two facets on opposite sides of an edge do not hide each other next to it.
/// The images of both end at the image of the edge.
bool UncertainEdges::is_smooth(VertexId a, VertexId b) const {
  const auto found = edges_.find(key_of(a, b));
  if (found == edges_.end() || found->second.count != 2) return false;
  const auto [f, g] = std::pair(found->second.facet[0], found->second.facet[1]);
  if (enclosures_.facets[f].state != State::proven || enclosures_.facets[g].state != State::proven)
    return false;
  if (parent_[f] == parent_[g]) return true;
  if (of_ == AmbiguitiesOf::directions) return false;
  glm::dvec3 edge[2]{};
  double side[2]{};
  for (const int which : {0, 1}) {
    const FacetId facet = which == 0 ? f : g;
    const auto& seen = enclosures_.facets[facet].seen;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId vertex = mesh_.facets[facet][k];
      if (vertex == a) edge[0] = seen[k];
      if (vertex == b) edge[1] = seen[k];
    }
    for (std::size_t k = 0; k < 3; ++k)
      if (const VertexId vertex = mesh_.facets[facet][k]; vertex != a && vertex != b)
        side[which] = glm::dot(glm::cross(edge[0], edge[1]), seen[k]);
  }
  return side[0] * side[1] < 0;
}

bool UncertainEdges::is_smooth_between(FacetId f, FacetId g) const {
  for (std::size_t k = 0; k < 3; ++k) {
    const VertexId a = mesh_.facets[f][k], b = mesh_.facets[f][(k + 1) % 3];
    const auto found = edges_.find(key_of(a, b));
    if (found != edges_.end() && found->second.count == 2 &&
        (found->second.facet[0] == g || found->second.facet[1] == g))
      return is_smooth(a, b);
  }
  return false;
}

double UncertainEdges::half_width(VertexId a, VertexId b) const {
  const auto found = edges_.find(key_of(a, b));
  return found == edges_.end() ? 0 : found->second.widest_rad * 1.01 + 1e-12;
}

void UncertainEdges::strip(const glm::dvec3& from, const glm::dvec3& to, double half_width_rad,
                           const Nearby& nearby, const AmbiguitySink& sink, const EdgeOf* edge) const {
  const glm::dvec3 start = glm::normalize(from), end = glm::normalize(to);
  const double length = glm::distance(start, end);
  if (!(length > 0) || !(half_width_rad < 0.1)) {
    if (!(half_width_rad < 0.1))
      for (const FacetId f : nearby.facets)
        sink({0, std::numeric_limits<double>::infinity(), enclosures_.facets[f].most, f,
              enclosures_.facets[f].seen});
    return;
  }
  // The strip is divided, so that facets behind it are not spread over more samples than necessary.
  const int parts =
      int(std::ceil(std::clamp(length / (8 * half_width_rad), std::max(1.0, 8 * length), 16.0)));
  const glm::dvec3 across = glm::normalize(glm::cross(start, end));
  for (int i = 0; i < parts; ++i) {
    const glm::dvec3 a = glm::normalize(start + double(i) / parts * (end - start)),
                     b = glm::normalize(start + double(i + 1) / parts * (end - start)),
                     middle = glm::normalize(a + b);
    const double half = glm::distance(a, b), w = half_width_rad;
    const Cone cone{middle, half + w};
    each_within(nearby, cone, [&](FacetId f) {
      // Facets do not hide their own points. clash() treats points that another facet of the same edge
      // hides.
      if (edge != nullptr && edge->count <= 2 &&
          (f == edge->facet[0] || (edge->count == 2 && f == edge->facet[1])))
        return;
      const FacetEnclosure& facet = enclosures_.facets[f];
      const double beyond = facet.travel_path_error_m / facet.nearest_m * 1.01, wide = (w + beyond) * 1.02;
      Polygon part(facet.seen.begin(), facet.seen.end());
      const double lean = wide / std::max(glm::dot(middle, a) - wide, 0.1);
      part = clipped(part, across + lean * middle);
      part = clipped(part, lean * middle - across);
      part = clipped(part, glm::cross(across, a) + lean * middle);
      part = clipped(part, glm::cross(b, across) + lean * middle);
      if (part.empty()) return;
      const auto [nearest, farthest] = ranges_of(part, facet.plane_m);
      // The solid angle is that of an arc of at most 1.01 times its chord, with its surroundings. A
      // direction is ambiguous next to the edge. A point is ambiguous next to all its possible apparent
      // positions there.
      const double about = of_ == AmbiguitiesOf::directions ? w : wide,
                   angle_sr = (1.01 * half + 2 * about) * 2 * about * 1.01;
      sink({nearest - facet.shift_m - facet.travel_path_error_m,
            farthest + facet.shift_m + facet.travel_path_error_m,
            std::min(facet.most_per_sr * angle_sr, facet.most), f, part});
    });
  }
}

void UncertainEdges::clash(const AmbiguousPiece& piece, FacetId other, const AmbiguitySink& sink) const {
  const FacetEnclosure &one = enclosures_.facets[piece.facet], &two = enclosures_.facets[other];
  const double off = one.shift_m + two.shift_m;
  Polygon part = piece.corners_m;
  // Region of the other facet, slightly widened.
  const double beside = two.travel_path_error_m / two.nearest_m * 1.02 + 1e-12;
  const Cone whole = cone_of(part);
  const auto give = [&](double beyond_m) {
    const auto [nearest, farthest] = ranges_of(part, one.plane_m);
    const double from = nearest - beyond_m, to = farthest + beyond_m, angle_sr = solid_angle_of(part);
    if (of_ == AmbiguitiesOf::directions)
      return sink({from, to, (one.most_per_sr + two.most_per_sr) * angle_sr});
    sink({from, to, one.most_per_sr * angle_sr, piece.facet, part});
    // Points of the other facet may lie outside of this region, so all of its points are included.
    sink({std::min(from, two.nearest_m), std::max(to, two.farthest_m), two.most_per_sr * angle_sr, other,
          two.seen});
  };
  if (!(whole.spread_rad < 1.4 && beside < 0.1)) return give(off);  // the region cannot be clipped
  const double turning = glm::dot(glm::cross(two.seen[0], two.seen[1]), two.seen[2]) < 0 ? -1 : 1;
  const double lean = beside / std::cos(whole.spread_rad);
  for (std::size_t k = 0; k < 3 && !part.empty(); ++k) {
    const glm::dvec3 edge = glm::cross(two.seen[k], two.seen[(k + 1) % 3]);
    part = clipped(part, turning * edge / glm::length(edge) + lean * whole.axis);
  }
  if (part.size() < 3) return;
  // Ranges to the two planes differ by (N . direction) / (s1 s2), where s1 and s2 are the sines of their
  // grazing angles.
  const glm::dvec3 depth = one.plane_m * two.normal - two.plane_m * one.normal;
  const double close =
      off * (1 + 1e-6) / std::cos(whole.spread_rad) + enclosure_slack * (one.plane_m + two.plane_m) * 1e-3;
  part = clipped(part, depth + close * whole.axis);
  part = clipped(part, close * whole.axis - depth);
  if (part.size() < 3) return;
  give(2 * off + enclosure_slack);
}

void UncertainEdges::add_walls(std::span<const Wall> walls, double off_rad, std::span<const FacetId> nearby,
                               const AmbiguitySink& sink) const {
  if (walls.empty()) return;
  const Nearby near = nearby_of(nearby);
  // The additional angle covers the rounding of rays.
  for (const Wall& wall : walls) strip(wall.first, wall.second, off_rad + 1e-9, near, sink);
}

void UncertainEdges::add_ambiguities(const NameContext& context, const TubeVisibility& seen,
                                     std::span<const AmbiguousPiece> pieces, std::span<const FacetId> nearby,
                                     const AmbiguitySink& sink) const {
  const Nearby near = nearby_of(nearby);
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    stop_if_wanted();
    const NamedPiece& named = seen.pieces[p];
    const AmbiguousPiece& piece = pieces[p];
    // Boundary of the piece. Among the planes that two neighbouring corners share, these are the planes
    // through mesh edges.
    for (std::uint32_t k = 0; k < named.count; ++k) {
      const CornerName &c = seen.corners[named.first + k],
                       &d = seen.corners[named.first + (k + 1) % named.count];
      const auto on = [](const PlaneName& plane, const CornerName& corner) {
        return corner.point != no_point ? plane.contains(corner.point)
                                        : plane == corner.p || plane == corner.q;
      };
      std::vector<PlaneName> planes;
      if (c.point != no_point && d.point != no_point)
        planes.push_back({std::min(c.point, d.point), std::max(c.point, d.point)});
      else if (c.point == no_point)
        for (const PlaneName& plane : {c.p, c.q})
          if (on(plane, d)) planes.push_back(plane);
      if (c.point != no_point && d.point == no_point)
        for (const PlaneName& plane : {d.p, d.q})
          if (on(plane, c)) planes.push_back(plane);
      const auto direction = [&](const CornerName& corner) {
        const glm::dvec3 e = direction_of(context, corner);
        return e / glm::length(e);
      };
      for (const PlaneName& plane : planes) {
        // Walls are exact. clash() treats crossings of facets.
        if (plane.depth || ((plane.a | plane.b) & ray_bit) || is_smooth(plane.a, plane.b)) continue;
        const auto edge = edges_.find(key_of(plane.a, plane.b));
        strip(direction(c), direction(d), half_width(plane.a, plane.b), near, sink,
              of_ == AmbiguitiesOf::places && edge != edges_.end() ? &edge->second : nullptr);
      }
    }
    if (enclosures_.facets[piece.facet].state != State::proven || piece.corners_m.size() < 3) continue;
    const FacetEnclosure& one = enclosures_.facets[piece.facet];
    each_within(near, cone_of(piece.corners_m), [&](FacetId f) {
      const FacetEnclosure& two = enclosures_.facets[f];
      if (of_ == AmbiguitiesOf::places && is_smooth_between(piece.facet, f)) return;
      if (parent_[f] != parent_[piece.facet] && two.nearest_m - two.shift_m <= one.farthest_m + one.shift_m &&
          two.farthest_m + two.shift_m >= one.nearest_m - one.shift_m)
        clash(piece, f, sink);
    });
  }
}

}  // namespace tubefoot
