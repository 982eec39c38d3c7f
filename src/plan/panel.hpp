// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <string>

#include "plan/seabed.hpp"
#include "plan/sheet.hpp"

namespace tubefoot {

/// From where a scene is looked at: which directions are to the right and up on the paper, and where their
/// zero is.
struct View {
  glm::dvec3 zero_m{0}, right{1, 0, 0}, up{0, 1, 0};

  glm::dvec2 of(glm::dvec3 place_m) const {
    return {glm::dot(place_m - zero_m, right), glm::dot(place_m - zero_m, up)};
  }
  /// How far a place lies before the paper.
  double depth_m(glm::dvec3 place_m) const { return glm::dot(place_m - zero_m, glm::cross(right, up)); }
};

/// A window in metres on a box of the paper, with axes.
class Panel {
 public:
  /// Widens the window to fit the box; `stretch`: how many times larger upwards than to the right.
  Panel(const Box& box, const View& view, const Window& window, double stretch = 1);

  const Box& box() const { return box_; }
  const View& view() const { return view_; }
  const Window& window() const { return window_; }
  double pixels_a_metre() const { return scale_.x; }
  /// On the paper.
  glm::dvec2 at(glm::dvec2 along_up_m) const {
    return {box_.left + (along_up_m.x - window_.lo_m.x) * scale_.x,
            box_.bottom - (along_up_m.y - window_.lo_m.y) * scale_.y};
  }
  glm::dvec2 at(glm::dvec3 place_m) const { return at(view_.of(place_m)); }

  /// Ticks, their labels and the axes' names, "east" and "up"; units are metres, or kilometres of large
  /// windows.
  void draw_axes(Sheet& sheet, const std::string& title, const std::string& right_name,
                 const std::string& up_name) const;

 private:
  Box box_;
  View view_;
  Window window_;
  glm::dvec2 scale_;
};

/// The stretch of a side view `size_m` wide and high that fills a box well: 1, 2 or 5 times a power of ten.
double stretch_of(glm::dvec2 size_m, double width, double height);

}  // namespace tubefoot
