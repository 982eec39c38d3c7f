// SPDX-License-Identifier: GPL-3.0-or-later
#include "footprints/footprint_place.hpp"

#include <fmt/format.h>

#include <cctype>
#include <glm/geometric.hpp>
#include <numeric>

namespace tubefoot {

FootprintPlace::FootprintPlace(const Scene& scene)
    : is_map_(scene.frame.is_georeferenced()),
      is_tangent_(scene.frame.is_tangent()),
      map_(scene.frame.map()),
      height_m_(is_map_ ? scene.frame.origin_height_m() : 0) {}

glm::dvec3 FootprintPlace::operator()(glm::dvec3 local_m) const {
  if (!is_map_) return local_m;
  return {map_.easting + local_m.x / map_.metres_per_unit, map_.northing + local_m.y / map_.metres_per_unit,
          local_m.z + height_m_};
}

std::string FootprintPlace::said() const {
  if (!is_map_) return "Coordinates are in metres east, north and up of the origin of the scene.";
  if (is_tangent_)
    return "Coordinates are in metres east and north on the plane that touches the Earth at the origin of "
           "the scene. Heights are in metres: the height above this plane plus the height of the origin.";
  return "Coordinates are in the CRS of the scene; heights are in metres.";
}

std::string component_name(const Scene& scene, const FootprintTable& table, std::size_t row) {
  return scene.report.components[table.component[row]].name;
}

std::string material_name(const Scene& scene, const FootprintTable& table, std::size_t row) {
  return scene.description.materials[table.material[row]].name;
}

std::string occluder_list(const FootprintTable& table, std::size_t row) {
  return fmt::format("{}", fmt::join(table.occluders_of(row), " "));
}

std::string as_word(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '.') c = '_';
  return name;
}

std::vector<double> area_shares(const FootprintTable& table, std::size_t row) {
  std::vector<double> shares;
  for (std::uint64_t piece = table.first_piece[row]; piece < table.first_piece[row + 1]; ++piece) {
    const auto corners = table.corners_of(piece);
    glm::dvec3 twice(0);
    for (std::size_t k = 1; k + 1 < corners.size(); ++k)
      twice += glm::cross(corners[k] - corners[0], corners[k + 1] - corners[0]);
    shares.push_back(glm::length(twice));
  }
  const double whole = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (double& share : shares) share = whole > 0 ? share / whole : 1 / static_cast<double>(shares.size());
  return shares;
}

}  // namespace tubefoot
