// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/finer_relief.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "geometry/numbers/grid_vector.hpp"

namespace tubefoot {
namespace {

double longest_edge2(const FacetMesh& mesh, FacetId facet, double unit_m) {
  const auto& f = mesh.facets[facet];
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 d = displacement(mesh.vertices[f[k]], mesh.vertices[f[(k + 1) % 3]]);
    longest = std::max(longest, glm::dot(d, d));
  }
  return longest * unit_m * unit_m;
}

/// Relative change for the grazing angles of both legs.
FinerRelief change_at(const ElevationField::LeftOut& left, double sine, double sine_back, double sample_m,
                      double weight) {
  const double by_slope = grazing_cotangent(sine) + grazing_cotangent(sine_back),
               by_height = (sine + sine_back) / 2 / sample_m;
  return {left.largest_slope * by_slope + left.largest_height_m * by_height,
          std::hypot(left.rms_slope * by_slope, left.rms_height_m * by_height), weight};
}

struct MeasuredPiece {
  double area_m2 = 0;
  glm::dvec3 middle_m{0};
};

MeasuredPiece measured(std::span<const glm::dvec3> corners) {
  glm::dvec3 doubled_area{0}, sum{0};
  for (std::size_t c = 0; c < corners.size(); ++c) {
    sum += corners[c];
    if (c > 1) doubled_area += glm::cross(corners[c - 1] - corners[0], corners[c] - corners[0]);
  }
  return {glm::length(doubled_area) / 2, sum / static_cast<double>(corners.size())};
}

}  // namespace

FinerRelief& FinerRelief::operator+=(const FinerRelief& o) {
  if (!(o.weight > 0)) return *this;
  const double share = o.weight / (weight + o.weight);
  largest += share * (o.largest - largest);
  rms += share * (o.rms - rms);
  weight += o.weight;
  return *this;
}

FinerRelief finer_relief(const CommonVisibility& visibility, const FacetMesh& mesh,
                         const OmittedRelief& omitted, double sample_m) {
  FinerRelief all;
  const auto left_out = [&](FacetId facet) -> const ElevationField::LeftOut& {
    return omitted.at(longest_edge2(mesh, facet, visibility.grid_unit_m()), mesh.material[facet]);
  };
  const auto add = [&](const SeenFacet& f, const ElevationField::LeftOut& left, glm::dvec3 at_m,
                       double area_m2) {
    const double tx = glm::length(at_m), rx = glm::distance(at_m, visibility.rx_m());
    if (!(tx > 0 && rx > 0)) return;
    const double sine_tx = std::min(1.0, f.plane.distance_m / tx),
                 sine_rx = std::min(1.0, f.rx_distance_m / rx),
                 weight = area_m2 * sine_tx * sine_rx / (tx * tx * rx * rx);
    all += change_at(left, sine_tx, sine_rx, sample_m, weight);
  };
  for (std::size_t number = visibility.first(); number < visibility.end(); ++number) {
    const SeenFacet f = visibility[number];
    const ElevationField::LeftOut& left = left_out(f.facet);
    for (std::uint32_t p = 0; p < f.piece_count; ++p) {
      const MeasuredPiece m = measured(visibility.part(number, f.first_piece + p).corners_m);
      add(f, left, m.middle_m, m.area_m2);
    }
  }
  for (const SharedHit& h : visibility.shared_hits()) {
    const SeenFacet f = visibility[h.seen];
    const double range = glm::length(h.at_m);
    add(f, left_out(f.facet), h.at_m, h.solid_angle_sr * (range * range) * range / f.plane.distance_m);
  }
  for (const HitBlock& block : visibility.hits())
    for (std::size_t k = 0; k < block.count; ++k) {
      const RayHit h = block[k];
      all += change_at(left_out(h.facet), h.sine_grazing, h.sine_grazing, sample_m,
                       h.solid_angle_sr * h.sine_grazing / (h.slant_range_m * h.slant_range_m));
    }
  return all;
}

}  // namespace tubefoot
