// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "footprints/footprint_table.hpp"

// What the writers of footprint files share.
namespace tubefoot {

/// Where the local frame's points lie on the scene's map (LocalFrame::map); without a georeference they stay
/// as they are.
class FootprintPlace {
 public:
  explicit FootprintPlace(const Scene& scene);
  bool is_map() const { return is_map_; }
  const std::string& crs_wkt() const { return map_.crs_wkt; }
  glm::dvec3 operator()(glm::dvec3 local_m) const;
  /// What coordinates are, in a sentence for people.
  std::string said() const;

 private:
  bool is_map_ = false, is_tangent_ = false;
  LocalFrame::Map map_;
  double height_m_ = 0;
};

std::string component_name(const Scene& scene, const FootprintTable& table, std::size_t row);
std::string material_name(const Scene& scene, const FootprintTable& table, std::size_t row);
/// Facets, separated by spaces.
std::string occluder_list(const FootprintTable& table, std::size_t row);
/// For formats whose names are words: anything but letters, digits, '-', '.' becomes '_'.
std::string as_word(std::string name);
/// Each piece's part of its footprint's area; they sum to 1.
std::vector<double> area_shares(const FootprintTable& table, std::size_t row);

}  // namespace tubefoot
