// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sensors/pictures/canvas.hpp"
#include "sensors/pictures/pixel_span.hpp"

namespace tubefoot {

/// Values of a uniform grid as one drawing of a page: column 0 is on the left, row 0 on top.
struct GridPanel {
  struct Axis {
    std::string title;
    double first = 0, last = 1;  ///< at the outer borders of the first and the last column or row
    bool counts = false;         ///< the axis counts items, such as pings: labels are in their middles
  };
  enum class Legend { none, decibels, phase, coherence };
  /// A point on the axes.
  struct Mark {
    double across = 0, down = 0;
    Colour colour{};
  };

  std::string title;
  std::size_t columns = 0, rows = 0;
  Axis across{}, down{};
  bool equal_scales = false;  ///< both axes are lengths in one unit
  Legend legend = Legend::decibels;
  /// Colour of the cells under a pixel; several threads call it.
  std::function<Colour(PixelSpan columns, PixelSpan rows)> colour{};
  std::vector<Mark> marks{};
};

/// Panels side by side, or below each other if they are much wider than high, with axes, legends and texts.
/// Throws std::invalid_argument for a page without panels, and for a panel without cells or colours.
struct GridPage {
  std::string title, subtitle, footer;
  std::vector<GridPanel> panels;
};
Canvas draw_grid_page(const GridPage& page, const std::string& font);

}  // namespace tubefoot
