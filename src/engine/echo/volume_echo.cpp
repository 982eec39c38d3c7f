// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/volume_echo.hpp"

#include <cmath>
#include <glm/geometric.hpp>
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
  for (; open < set.open_pieces.size() && set.open_pieces[open].tube == tube; ++open)
    content.open.push_back([&](const auto& part) {
      return std::vector<glm::dvec3>(part.begin(), part.end());
    }(part_of(set.open_directions, set.open_pieces[open])));
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

}  // namespace

bool needs_open_water(const VolumeScattering& volume, const BeamPatterns* patterns) {
  return patterns != nullptr || !volume.borders_m.empty();
}

Echo volume_echo(const History& history, const ReceiveBeams& beams, const RangeSamples& samples,
                 const EchoModel& model, const VolumeScattering& volume) {
  check(volume);
  ConeSums sums(beams, samples, model.absorption_db_per_m, model.patterns, model.pattern_tolerance);
  std::size_t surface = 0, open = 0;
  if (!needs_open_water(volume, model.patterns)) {
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
  VolumeRegions<DoubleSpace> regions(volume, model.path.tx.apex_m.z, samples.border_m(samples.count));
  for (std::uint32_t tube = 0; tube < history.tubes.tubes.size(); ++tube) {
    stop_if_wanted();
    regions.divide(tube_content(history, tube, surface, open),
                   [&](const DoubleSpace::Polygon& cone, double s_v_per_m) {
                     sums.add(cone, s_v_per_m, tube);
                   });
  }
  return {beams.count, samples.count, sums.energies()};
}

}  // namespace tubefoot
