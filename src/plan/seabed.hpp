// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "run/survey.hpp"

namespace tubefoot {

/// A rectangle in metres.
struct Window {
  glm::dvec2 lo_m{0}, hi_m{0};
};

/// Calls `take` with all facets of the terrain that overlap a window in plan, and possibly with others.
///
/// A terrain that is read by tiles may have many tiles in the window. `take` then receives coarse facets from
/// the lowest and highest points of the tiles. Returns whether facets were coarse. Throws InputError for a
/// raster that can no longer be read.
bool each_terrain_facet(const Survey& survey, const Window& window,
                        const std::function<void(const std::array<glm::dvec3, 3>&)>& take);

/// Heights of the terrain at the centres of cells in plan.
class PlanHeights {
 public:
  /// Covers a window with square cells, `most` of them along its longer side.
  PlanHeights(const Window& window, int most);

  void add(const std::array<glm::dvec3, 3>& facet);
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  double cell_m() const { return cell_m_; }
  const Window& window() const { return window_; }
  /// Columns count from the west, rows from the south. The result is NaN outside of the terrain.
  double up_m(int column, int row) const {
    return up_m_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                 static_cast<std::size_t>(column)];
  }
  /// Interpolates between the centres of cells; returns nothing outside of the terrain.
  std::optional<double> at(glm::dvec2 place_m) const;
  /// Returns the distance to the terrain along a ray. Returns nothing if it exceeds `most_m`, or if the ray
  /// starts below the terrain.
  std::optional<double> distance_m(glm::dvec3 from_m, glm::dvec3 direction, double most_m) const;
  double lowest_m() const { return lowest_m_; }
  double highest_m() const { return highest_m_; }
  bool empty() const { return lowest_m_ > highest_m_; }

 private:
  Window window_;
  double cell_m_;
  int columns_, rows_;
  std::vector<double> up_m_;
  double lowest_m_, highest_m_;
};

/// Draws heights from `low_m` to `high_m` as a PNG with light from the north-west. It is transparent
/// outside of the terrain.
std::string shaded(const PlanHeights& heights, double low_m, double high_m);
/// Returns the colour of a height in that picture without light, "#rrggbb".
std::string seabed_colour(double share_of_height);

/// Heights of the terrain along a line in a side view, by column. They are those in a vertical plane, or
/// the lowest and highest ones along the line of sight.
class Profile {
 public:
  Profile(double from_m, double to_m, int columns);

  /// Adds a facet with corners (along, up, depth in front of the plane). `cut`: only its intersection with
  /// the plane.
  void add(const std::array<glm::dvec3, 3>& facet, bool cut);
  std::size_t columns() const { return lowest_m_.size(); }
  double along_m(std::size_t column) const { return from_m_ + step_m_ * (static_cast<double>(column) + 0.5); }
  double lowest_m(std::size_t column) const {
    return lowest_m_[column];
  }  ///< +infinity if the column has no terrain
  double highest_m(std::size_t column) const {
    return highest_m_[column];
  }  ///< -infinity if the column has no terrain
  bool has(std::size_t column) const { return lowest_m_[column] <= highest_m_[column]; }

 private:
  void add(double along_a, double up_a, double along_b, double up_b);
  double from_m_, step_m_;
  std::vector<double> lowest_m_, highest_m_;
};

}  // namespace tubefoot
