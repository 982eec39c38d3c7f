// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tubefoot {

/// One series of a diagram; its points are joined in this order.
struct PlotSeries {
  std::string name;
  std::string note;  ///< text next to the last point, for example the order of convergence; may be empty
  std::vector<std::pair<double, double>> points;
  bool joined = true;
};

/// Scale of an axis.
enum class Scale { logarithmic, linear };

/// A diagram. Points that a logarithmic axis cannot show are omitted, except as `floor` describes.
struct Diagram {
  std::string title, x_label, y_label;
  std::vector<PlotSeries> series;
  Scale scale = Scale::logarithmic;  ///< scale of both axes
  double floor = 0;        ///< a dashed line; points below it are drawn on it as hollow dots; 0: none
  std::string floor_name;  ///< label of that line
};

/// Returns the colour of the n-th series, "#rrggbb", for other elements of the same subject. The colours
/// repeat.
const char* series_colour(std::size_t n);

/// Returns the diagram as a self-contained SVG of 760 x 520 pixels.
std::string to_svg(const Diagram& diagram);

}  // namespace tubefoot
