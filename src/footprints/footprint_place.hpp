// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "footprints/footprint_table.hpp"

// Functions that the writers of footprint files share.
namespace tubefoot {

/// Transforms points of the local frame to the scene's map (LocalFrame::map). Without a georeference it
/// returns them unchanged.
class FootprintPlace {
 public:
  explicit FootprintPlace(const Scene& scene);
  bool is_map() const { return is_map_; }
  const std::string& crs_wkt() const { return map_.crs_wkt; }
  glm::dvec3 operator()(glm::dvec3 local_m) const;
  /// Describes the coordinates in a sentence for the reader of a file.
  std::string said() const;

 private:
  bool is_map_ = false, is_tangent_ = false;
  LocalFrame::Map map_;
  double height_m_ = 0;
};

std::string component_name(const Scene& scene, const FootprintTable& table, std::size_t row);
std::string material_name(const Scene& scene, const FootprintTable& table, std::size_t row);
/// Returns the occluding facets, separated by spaces.
std::string occluder_list(const FootprintTable& table, std::size_t row);
/// Replaces each character except letters, digits, '-' and '.' by '_', for formats whose names are single
/// words.
std::string as_word(std::string name);
/// Returns the fraction of the footprint's area in each of its pieces. The fractions sum to 1.
std::vector<double> area_shares(const FootprintTable& table, std::size_t row);

}  // namespace tubefoot
