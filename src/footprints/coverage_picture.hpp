// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "footprints/coverage_file.hpp"
#include "run/survey.hpp"
#include "sensors/pictures/canvas.hpp"

namespace tubefoot {

/// A plan view of the number of pings that see each place, with north up. The highest surface hides those
/// below it. A pixel takes the value of the cell at its centre. If facets steeper than 60 degrees have more
/// than 5 % of the visible area, the picture also has a side view of them.
class CoveragePicture {
 public:
  /// The survey must outlive this object: the plan also shows the surface around the covered facets.
  explicit CoveragePicture(const Survey& survey) : survey_(survey) {}
  void add(const CoveredFacet& facet);
  bool empty() const { return polygons_.empty(); }
  /// Throws std::runtime_error if there is nothing to draw.
  Canvas draw(const std::string& title) const;
  /// Throws std::runtime_error that names the file.
  void write(const std::filesystem::path& file, const std::string& title) const;

 private:
  enum : int { out_of_sector = -2, in_shadow = -1 };
  struct Polygon {
    std::size_t first, count;
    int pings;  ///< number of pings, or one of the two values above
  };

  const Survey& survey_;
  std::vector<Polygon> polygons_;
  std::vector<glm::dvec3> corners_;
  glm::dvec2 lo_{1e300}, hi_{-1e300};
  int most_ = 1;
};

}  // namespace tubefoot
