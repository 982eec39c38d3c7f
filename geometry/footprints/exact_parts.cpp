// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/exact_parts.hpp"

#include "geometry/footprints/line_areas.hpp"
#include "geometry/footprints/seen_piece.hpp"
#include "geometry/steps/stop.hpp"
#include "geometry/visibility/exact_direction.hpp"

namespace tubefoot {
namespace {

using Rational = CGAL::Exact_rational;

/// Reorders the weights of a cone's vertices, which may be reversed, to the order of the mesh.
ExactWeights in_order_of(const FacetCone& cone, const ExactWeights& weights) {
  if (!cone.reversed) return weights;
  return {weights[0], weights[2], weights[1]};
}

}  // namespace

ExactVector between(const ExactWeights& weights, const std::array<ExactVector, 3>& corners) {
  ExactVector point;
  for (std::size_t c = 0; c < 3; ++c)
    point[c] = weights[0] * corners[0][c] + weights[1] * corners[1][c] + weights[2] * corners[2][c];
  return point;
}

std::vector<ExactWeights> exact_weights(const FacetMesh& mesh, GridPoint apex, const TubeVisibility& seen,
                                        const NamedPiece& piece) {
  FacetCone cone;
  FacetCone::make(mesh, piece.facet, apex, cone);
  std::array<ExactVector, 3> wall;  // opposite to each vertex
  for (std::size_t k = 0; k < 3; ++k)
    wall[k] = cross(exact(cone.point[(k + 1) % 3]), exact(cone.point[(k + 2) % 3]));
  std::vector<ExactWeights> all;
  for (const ExactVector& d : exact_directions({mesh, apex, seen.rays}, seen.corners, piece)) {
    stop_if_wanted();
    ExactWeights weights{dot(wall[0], d), dot(wall[1], d), dot(wall[2], d)};
    const Rational sum = weights[0] + weights[1] + weights[2];
    for (Rational& weight : weights) weight /= sum;
    all.push_back(in_order_of(cone, weights));
  }
  return all;
}

std::vector<ExactPart> FootprintSharer::exact(std::size_t number) const {
  const Both& both = facets_[number];
  OnFacet on(*this, both);
  const auto place = [&](std::size_t k) {
    const std::array<std::int64_t, 3> p{on.from_transmitter.point[k].x, on.from_transmitter.point[k].y,
                                        on.from_transmitter.point[k].z},
        q{on.from_transmitter.point[0].x, on.from_transmitter.point[0].y, on.from_transmitter.point[0].z};
    const auto u = std::size_t(on.chart.u), v = std::size_t(on.chart.v);
    return std::array{Rational(p[u] - q[u]), Rational(p[v] - q[v])};
  };
  const auto first = place(1), second = place(2);
  const Rational whole = first[0] * second[1] - first[1] * second[0];
  std::vector<ExactPart> parts;
  LinePolygon polygon;
  for (SeenPiece& s : on.sent)
    for (SeenPiece& h : on.received) {
      stop_if_wanted();
      if (!images_ && !s.may_meet(h)) continue;
      shared_by(s, h, polygon);
      if (polygon.empty()) continue;
      ExactPart part{both.facet, mesh_.facets[on.from_transmitter.id], s.tube(), h.tube(), {}};
      for (std::size_t k = 0; k < polygon.size(); ++k) {
        const PlaneLine &p = *polygon[k == 0 ? polygon.size() - 1 : k - 1], &q = *polygon[k];
        const Integer z = integer(HugeInt(p.a * q.b - p.b * q.a));
        if (z == 0) continue;  // in plain double a polygon can have the same line twice
        const Rational x = Rational(integer(HugeInt(p.b * q.c - p.c * q.b))) / Rational(z),
                       y = Rational(integer(HugeInt(p.c * q.a - p.a * q.c))) / Rational(z);
        const Rational one = (x * second[1] - y * second[0]) / whole,
                       two = (first[0] * y - first[1] * x) / whole;
        part.corners.push_back(in_order_of(on.from_transmitter, {Rational(1 - one - two), one, two}));
      }
      if (part.corners.size() > 2) parts.push_back(std::move(part));
    }
  return parts;
}

}  // namespace tubefoot
