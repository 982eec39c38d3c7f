// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "sensors/pictures/canvas.hpp"

namespace tubefoot {

/// A map of the local frame, north up: its pixels from (left, top) on, its south-west corner and its scale. A
/// side view has other titles of its axes.
struct MapPlot {
  int left = 0, top = 0, width = 0, height = 0;
  double west_m = 0, south_m = 0, pixels_per_m = 1;
  std::string across_title = "east (m)", upward_title = "north (m)";

  /// Width in pixels of the labels of the northings left of the map, including ticks.
  int northings_width(const std::string& font) const;
  /// Draws ticks, labels and titles. They need 62 pixels below, northings_width() to the left, and 32 above.
  void draw_axes(Canvas& canvas) const;

 private:
  double step_m() const;
};

}  // namespace tubefoot
