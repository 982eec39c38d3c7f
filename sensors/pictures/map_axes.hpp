// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "sensors/pictures/canvas.hpp"

namespace tubefoot {

/// A map of the local frame, north up, in the pixels from (left, top) on; its south-west corner and scale.
struct MapPlot {
  int left = 0, top = 0, width = 0, height = 0;
  double west_m = 0, south_m = 0, pixels_per_m = 1;

  /// Pixels that the labels of the northings take to the left of the map, their ticks included.
  int northings_width(const std::string& font) const;
  /// Ticks, labels and titles: 62 pixels below, northings_width() to the left, 32 above.
  void draw_axes(Canvas& canvas) const;

 private:
  double step_m() const;
};

}  // namespace tubefoot
