// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/volume_echo.hpp"

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
    return std::vector<glm::dvec3>(all.begin() + piece.first, all.begin() + piece.first + piece.count);
  };
  for (; surface < set.footprints.size() && set.footprints[surface].tube == tube; ++surface) {
    const Footprint& footprint = set.footprints[surface];
    for (std::uint32_t p = 0; p < footprint.piece_count; ++p)
      content.surfaces.push_back({{footprint.plane_normal, footprint.plane_distance_m},
                                  part_of(set.corners_m, set.pieces[footprint.first_piece + p])});
  }
  for (; open < set.open_pieces.size() && set.open_pieces[open].tube == tube; ++open)
    content.open.push_back(part_of(set.open_directions, set.open_pieces[open]));
  return content;
}

Echo volume_echo(const History& history, const ReceiveBeams& beams, const RangeSamples& samples,
                 const EchoModel& model, const VolumeScattering& volume) {
  ConeSums sums(beams, samples, model.absorption_db_per_m, model.patterns, model.pattern_tolerance);
  VolumeRegions<DoubleSpace> regions(volume, model.path.tx.apex_m.z, samples.border_m(samples.count));
  std::size_t surface = 0, open = 0;
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
