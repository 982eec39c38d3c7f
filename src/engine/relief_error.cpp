// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/relief_error.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tubefoot {
namespace {

void raise(ElevationField::LeftOut& to, const ElevationField::LeftOut& by) {
  to.rms_height_m = std::max(to.rms_height_m, by.rms_height_m);
  to.rms_slope = std::max(to.rms_slope, by.rms_slope);
  to.largest_height_m = std::max(to.largest_height_m, by.largest_height_m);
  to.largest_slope = std::max(to.largest_slope, by.largest_slope);
}

/// Facets seen edge on scatter nothing that counts.
constexpr double lowest_sine = 0.02;

double cotangent(double sine) {
  const double s = std::max(sine, lowest_sine);
  return std::sqrt(std::max(0.0, 1 - s * s)) / s;
}

double longest_edge2(const FacetMesh& mesh, FacetId facet, double unit_m) {
  const auto& f = mesh.facets[facet];
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const GridPoint a = mesh.vertices[f[k]], b = mesh.vertices[f[(k + 1) % 3]];
    const glm::dvec3 d{double(a.x) - b.x, double(a.y) - b.y, double(a.z) - b.z};
    longest = std::max(longest, glm::dot(d, d));
  }
  return longest * unit_m * unit_m;
}

}  // namespace

OmittedRelief::OmittedRelief(std::span<const std::shared_ptr<const ElevationField>> relief, double finest_m)
    : finest2_m2_(finest_m * finest_m), by_material_(relief.size()) {
  for (std::size_t m = 0; m < relief.size(); ++m) {
    if (!relief[m]) continue;
    largest_height_m_ = std::max(largest_height_m_, relief[m]->largest_m());
    for (std::size_t k = 0; k < steps; ++k) {
      by_material_[m][k] = relief[m]->left_out(finest_m * std::exp2(static_cast<double>(k) / 4));
      if (k > 0) raise(by_material_[m][k], by_material_[m][k - 1]);
      raise(largest_[k], by_material_[m][k]);
    }
  }
}

std::size_t OmittedRelief::step(double edge2_m2) const {
  if (!(edge2_m2 > finest2_m2_)) return 0;
  const double k = std::ceil(2 * std::log2(edge2_m2 / finest2_m2_));
  return static_cast<std::size_t>(std::min(k, static_cast<double>(steps - 1)));
}

double omitted_change(const ElevationField::LeftOut& left_out, double edge2_m2, const Resolution& cell) {
  const double cot = cotangent(cell.sine_grazing), s = left_out.rms_slope;
  const double patches = std::max(1.0, cell.range_m * cell.beam_rad * cell.sample_m / edge2_m2);
  return 2 * s * cot / std::sqrt(patches) + s * s * (0.5 + cot * cot) +
         left_out.rms_height_m * cell.sine_grazing / cell.sample_m * std::sqrt(2 / patches);
}

LargestChange largest_change(const History& history, const FacetMesh& mesh, const OmittedRelief& omitted,
                             double sample_m) {
  LargestChange all;
  const auto add = [&](FacetId facet, double weight, double sine) {
    const ElevationField::LeftOut& left =
        omitted.at(longest_edge2(mesh, facet, history.grid_unit_m), mesh.material[facet]);
    all.weight += weight;
    all.weighted +=
        weight * (2 * left.largest_slope * cotangent(sine) + left.largest_height_m * sine / sample_m);
  };
  const FootprintSet& set = history.footprints;
  for (const Footprint& f : set.footprints)
    for (std::uint32_t p = 0; p < f.piece_count; ++p) {
      const Piece& piece = set.pieces[f.first_piece + p];
      glm::dvec3 doubled_area{0}, sum{0};
      const glm::dvec3 first = set.corners_m[piece.first];
      for (std::uint32_t c = 0; c < piece.count; ++c) {
        const glm::dvec3 corner = set.corners_m[piece.first + c];
        sum += corner;
        if (c > 1) doubled_area += glm::cross(set.corners_m[piece.first + c - 1] - first, corner - first);
      }
      const double range = glm::length(sum) / piece.count;
      if (!(range > 0)) continue;
      const double sine = std::min(1.0, f.plane_distance_m / range);
      add(f.facet, glm::length(doubled_area) * sine * sine / std::pow(range, 4), sine);
    }
  for (const RayHit& h : history.hits)
    add(h.facet, h.solid_angle_sr * h.sine_grazing / (h.slant_range_m * h.slant_range_m), h.sine_grazing);
  return all;
}

}  // namespace tubefoot
