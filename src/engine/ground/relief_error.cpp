// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/ground/relief_error.hpp"

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

namespace {

/// Where rays come and go at those grazing angles.
FinerRelief change_at(const ElevationField::LeftOut& left, double sine, double sine_back, double sample_m,
                      double weight) {
  const double by_slope = cotangent(sine) + cotangent(sine_back),
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

FinerRelief finer_relief(const History& history, const FacetMesh& mesh, const OmittedRelief& omitted,
                         double sample_m) {
  FinerRelief all;
  const auto add = [&](FacetId facet, double weight, double sine) {
    const ElevationField::LeftOut& left =
        omitted.at(longest_edge2(mesh, facet, history.grid_unit_m), mesh.material[facet]);
    all += change_at(left, sine, sine, sample_m, weight);
  };
  const FootprintSet& set = history.footprints;
  for (const Footprint& f : set.footprints)
    for (std::uint32_t p = 0; p < f.piece_count; ++p) {
      const Piece& piece = set.pieces[f.first_piece + p];
      const MeasuredPiece m = measured(std::span(set.corners_m).subspan(piece.first, piece.count));
      const double range = glm::length(m.middle_m);
      if (!(range > 0)) continue;
      const double sine = std::min(1.0, f.plane_distance_m / range);
      add(f.facet, m.area_m2 * sine * sine / std::pow(range, 4), sine);
    }
  for (const RayHit& h : history.hits)
    add(h.facet, h.solid_angle_sr * h.sine_grazing / (h.slant_range_m * h.slant_range_m), h.sine_grazing);
  return all;
}

FinerRelief finer_relief(const BistaticHistory& history, const FacetMesh& mesh, const OmittedRelief& omitted,
                         double sample_m) {
  FinerRelief all;
  const SharedFootprints& shared = history.shared;
  for (const SharedFacet& f : shared.facets) {
    const ElevationField::LeftOut& left =
        omitted.at(longest_edge2(mesh, f.facet, history.grid_unit_m), mesh.material[f.facet]);
    for (std::uint32_t p = 0; p < f.piece_count; ++p) {
      const SharedPiece& piece = shared.pieces[f.first_piece + p];
      const MeasuredPiece m = measured(std::span(shared.corners_m).subspan(piece.first, piece.count));
      const double there = glm::length(m.middle_m), back = glm::distance(m.middle_m, shared.receiver_m);
      if (!(there > 0 && back > 0)) continue;
      const double sine = std::min(1.0, f.transmit_distance_m / there),
                   sine_back = std::min(1.0, f.receive_distance_m / back),
                   weight = m.area_m2 * sine * sine_back / (there * there * back * back);
      all += change_at(left, sine, sine_back, sample_m, weight);
    }
  }
  return all;
}

}  // namespace tubefoot
