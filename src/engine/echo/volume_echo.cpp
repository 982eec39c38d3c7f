// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/volume_echo.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "engine/echo/cone_sums.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {

TubeContent<DoubleSpace> tube_content(const History& history, std::uint32_t tube, std::size_t& surface,
                                      std::size_t& open) {
  TubeContent<DoubleSpace> content;
  for (std::size_t k = 0; k < content.rays.size(); ++k) {
    const GridPoint& ray = history.tubes.rays[history.tubes.tubes[tube][k]];
    content.rays[k] = glm::normalize(glm::dvec3(double(ray.x), double(ray.y), double(ray.z)));
  }
  const FootprintSet& set = history.footprints;
  const auto part_of = [](const std::vector<glm::dvec3>& all, const auto& piece) {
    return std::span(all).subspan(piece.first, piece.count);
  };
  for (; surface < set.footprints.size() && set.footprints[surface].tube == tube; ++surface) {
    const Footprint& footprint = set.footprints[surface];
    for (std::uint32_t p = 0; p < footprint.piece_count; ++p)
      content.surfaces.push_back({{footprint.plane_normal, footprint.plane_distance_m},
                                  part_of(set.corners_m, set.pieces[footprint.first_piece + p])});
  }
  for (; open < set.open_pieces.size() && set.open_pieces[open].tube == tube; ++open) {
    const auto part = part_of(set.open_directions, set.open_pieces[open]);
    content.open.emplace_back(part.begin(), part.end());
  }
  return content;
}

namespace {

/// Solid angle of a tube as two triangles (Van Oosterom and Strackee 1983).
double solid_angle_of(const std::array<glm::dvec3, 4>& rays) {
  const auto triangle = [](glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
    return 2 * std::atan2(std::abs(glm::dot(a, glm::cross(b, c))),
                          1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
  };
  return triangle(rays[0], rays[1], rays[2]) + triangle(rays[0], rays[2], rays[3]);
}

/// Distance from a height to the nearest layer that scatters.
double nearest_scattering_m(const VolumeScattering& volume, double height_m) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t layer = 0; layer < volume.s_v_per_m.size(); ++layer) {
    if (volume.s_v_per_m[layer] == 0) continue;
    const double below = layer == 0 ? 0 : volume.borders_m[layer - 1] - height_m,
                 above = layer == volume.borders_m.size() ? 0 : height_m - volume.borders_m[layer];
    nearest = std::min(nearest, std::max({below, above, 0.0}));
  }
  return nearest;
}

}  // namespace

bool needs_open_water(const VolumeScattering& volume, bool has_patterns) {
  return has_patterns || !volume.borders_m.empty();
}

Echo volume_echo(const History& history, const ReceiveBeams& beams, const RangeSamples& samples,
                 const EchoModel& model, const VolumeScattering& volume) {
  check(volume);
  ConeSums sums(beams, samples, model.absorption_db_per_m, model.patterns, model.pattern_tolerance);
  std::size_t surface = 0, open = 0;
  if (!needs_open_water(volume, model.patterns != nullptr)) {
    const double s_v_per_m = volume.s_v_per_m.front();
    std::vector<double> solid_angle_sr(std::size_t(beams.count));
    for (std::uint32_t tube = 0; tube < history.tubes.tubes.size(); ++tube) {
      stop_if_wanted();
      const TubeContent<DoubleSpace> content = tube_content(history, tube, surface, open);
      for (const DoubleSpace::Polygon& polygon : content.surfaces) sums.add(polygon, s_v_per_m, tube);
      solid_angle_sr[beams.of_tube[tube]] += solid_angle_of(content.rays);
    }
    for (std::uint32_t beam = 0; beam < solid_angle_sr.size(); ++beam)
      sums.add_rest(solid_angle_sr[beam], s_v_per_m, beam);
    return {beams.count, samples.count, sums.energies()};
  }
  const double apex_m = model.path.tx.apex_m.z;
  VolumeRegions<DoubleSpace> regions(volume, apex_m, samples.border_m(samples.count));
  for (std::uint32_t tube = 0; tube < history.tubes.tubes.size(); ++tube) {
    stop_if_wanted();
    regions.divide(
        tube_content(history, tube, surface, open),
        [&](const DoubleSpace::Polygon& cone, double s_v_per_m) { sums.add(cone, s_v_per_m, tube); });
  }
  std::vector<double> energy = sums.energies();
  // In front of the nearest layer that scatters, terms of both signs cancel except for their errors.
  const double nearest_m = nearest_scattering_m(volume, apex_m);
  for (int k = 0; k < samples.count && samples.border_m(k + 1) <= nearest_m; ++k)
    for (int beam = 0; beam < beams.count; ++beam)
      energy[std::size_t(beam) * std::size_t(samples.count) + std::size_t(k)] = 0;
  return {beams.count, samples.count, std::move(energy)};
}

}  // namespace tubefoot
