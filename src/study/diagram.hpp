// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tubefoot {

/// One line of a diagram: points in the order they are joined.
struct PlotSeries {
  std::string name;
  std::string note;  ///< beside the line's last point, e.g. its order; may be empty
  std::vector<std::pair<double, double>> points;
  bool joined = true;
};

/// How an axis counts.
enum class Scale { logarithmic, linear };

/// A diagram. What a logarithmic axis cannot show is left out of it, but see `floor`.
struct Diagram {
  std::string title, x_label, y_label;
  std::vector<PlotSeries> series;
  Scale scale = Scale::logarithmic;  ///< of both axes
  double floor = 0;                  ///< a dashed line; points below it are drawn on it, hollow. 0: none
  std::string floor_name;            ///< what the line says
};

/// "#rrggbb" of the n-th series, for what else is drawn of the same things; few colours, then again.
const char* series_colour(std::size_t n);

/// The diagram as a self-contained SVG of 760 x 520 pixels.
std::string to_svg(const Diagram& diagram);

}  // namespace tubefoot
