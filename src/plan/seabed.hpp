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

/// Calls `take` with the terrain's facets that come into a window seen from above, and maybe others. Of
/// terrain that is read by tiles, where many come into it: with coarse ones, made of how high and low its
/// tiles reach. Returns whether they were coarse. Throws InputError for a raster that can no longer be read.
bool each_terrain_facet(const Survey& survey, const Window& window,
                        const std::function<void(const std::array<glm::dvec3, 3>&)>& take);

/// How high the terrain is at the middles of cells, seen from above.
class PlanHeights {
 public:
  /// Over a window, in square cells, as many as `most` along its longer side.
  PlanHeights(const Window& window, int most);

  void add(const std::array<glm::dvec3, 3>& facet);
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  double cell_m() const { return cell_m_; }
  const Window& window() const { return window_; }
  /// Columns from the west, rows from the south; not a number where no terrain is.
  double up_m(int column, int row) const {
    return up_m_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                 static_cast<std::size_t>(column)];
  }
  /// Between the middles of cells; nothing where no terrain is.
  std::optional<double> at(glm::dvec2 place_m) const;
  /// How far it is to the terrain; nothing where `most_m` do not reach it, and from below it.
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

/// Heights as a picture (PNG), light from the north-west: from `low` to `high` metres; clear where no terrain
/// is.
std::string shaded(const PlanHeights& heights, double low_m, double high_m);
/// "#rrggbb" of a height on that picture, without light.
std::string seabed_colour(double share_of_height);

/// How high the terrain is along a line seen from the side, column by column: in a plane, or between the
/// lowest and the highest of all that lies before and behind it.
class Profile {
 public:
  Profile(double from_m, double to_m, int columns);

  /// A facet, its corners as (along, up, depth before the plane). `cut`: where it crosses the plane only.
  void add(const std::array<glm::dvec3, 3>& facet, bool cut);
  std::size_t columns() const { return lowest_m_.size(); }
  double along_m(std::size_t column) const { return from_m_ + step_m_ * (static_cast<double>(column) + 0.5); }
  double lowest_m(std::size_t column) const { return lowest_m_[column]; }    ///< infinite where there is none
  double highest_m(std::size_t column) const { return highest_m_[column]; }  ///< less than infinite, likewise
  bool has(std::size_t column) const { return lowest_m_[column] <= highest_m_[column]; }

 private:
  void add(double along_a, double up_a, double along_b, double up_b);
  double from_m_, step_m_;
  std::vector<double> lowest_m_, highest_m_;
};

}  // namespace tubefoot
