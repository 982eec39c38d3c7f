// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <string>

#include "plan/seabed.hpp"
#include "plan/sheet.hpp"

namespace tubefoot {

/// View of a scene: the directions to the right and upwards on the drawing, and the origin.
struct View {
  glm::dvec3 zero_m{0}, right{1, 0, 0}, up{0, 1, 0};

  glm::dvec2 of(glm::dvec3 place_m) const {
    return {glm::dot(place_m - zero_m, right), glm::dot(place_m - zero_m, up)};
  }
  /// Distance of a position in front of the drawing plane, in m.
  double depth_m(glm::dvec3 place_m) const { return glm::dot(place_m - zero_m, glm::cross(right, up)); }
};

/// A window in metres on a box of the drawing, with axes.
class Panel {
 public:
  /// Widens the window to fit the box. `stretch`: ratio of the vertical to the horizontal scale.
  Panel(const Box& box, const View& view, const Window& window, double stretch = 1);

  const Box& box() const { return box_; }
  const View& view() const { return view_; }
  const Window& window() const { return window_; }
  double pixels_a_metre() const { return scale_.x; }
  /// Position on the drawing.
  glm::dvec2 at(glm::dvec2 along_up_m) const {
    return {box_.left + (along_up_m.x - window_.lo_m.x) * scale_.x,
            box_.bottom - (along_up_m.y - window_.lo_m.y) * scale_.y};
  }
  glm::dvec2 at(glm::dvec3 place_m) const { return at(view_.of(place_m)); }

  /// Draws ticks, their labels and the names of the axes, for example "east" and "up". Units are metres, or
  /// kilometres for large windows.
  void draw_axes(Sheet& sheet, const std::string& title, const std::string& right_name,
                 const std::string& up_name) const;

 private:
  Box box_;
  View view_;
  Window window_;
  glm::dvec2 scale_;
};

/// Returns the stretch with which a side view of `size_m` fills a box well: 1, 2 or 5 times a power of ten.
double stretch_of(glm::dvec2 size_m, double width, double height);

}  // namespace tubefoot
