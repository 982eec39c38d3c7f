// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "geometry/integrals/path_cut.hpp"

namespace tubefoot {

/// Integrates as PathCutter does, for polygons that are small compared with their distances from both apexes
/// and from the plane's point of shortest path. In such a polygon the path grows along all parallels to one
/// direction, the gradient at the middle. A cell lies between two curves, each an edge or an ellipse, over
/// an interval across that direction. No rotation is necessary. For an analytic integrand one Gauss-Legendre
/// rule per cell suffices, and its order follows from the cell's size. For other integrands the order rises
/// until two rules agree, or the cell is halved.
///
/// Law P4 (compact): the result agrees, within the tolerance, with that of cells about the point of shortest
/// path.
class CompactPathCutter {
 public:
  /// The arguments of PathCutter::add() for one receiver.
  struct Task {
    PathCutter::Receiver receiver;
    const PathCutter::Integrand& integrand;
    const PathCutter::Work& work;
    std::span<const double> borders_m;
    std::span<double> out;
  };
  /// Adds the compact parts of the polygon, and halves the polygon where it is not compact. Appends the
  /// parts that are not compact after a few halvings to `left`, as offsets from the polygon's first corner.
  void add(const PlanarPolygon& polygon, const Task& task, std::vector<PlanarPolygon>& left);

 private:
  static constexpr int most_nodes = 10;

  /// An edge in coordinates along and across the gradient. The end with the smaller `across` comes first.
  struct Edge {
    glm::dvec2 from, to;
    bool far;  ///< the interior lies on the side of smaller `along`
    double at(double across) const;
  };
  /// An apex over the plane.
  struct Over {
    double height2 = 0;
    glm::dvec2 foot{0};
    double range(glm::dvec2 p) const;
  };
  /// Two edges over an interval across the gradient.
  struct Strip {
    const Edge *near, *far;
    double from, to;
  };
  struct Cell {
    const Edge *near, *far;
    double near_path, far_path;  ///< path of the ellipse that bounds the cell; 0 if the edge bounds it
    double from, to;             ///< across the gradient
    double begin = 0, end = 1;   ///< fraction of the distance from near to far
    int refinements = 0;
  };

  void cut(const std::vector<glm::dvec2>& corners, int halvings, std::vector<PlanarPolygon>& left);
  bool is_compact(const std::vector<glm::dvec2>& corners);
  void cut_compact(const std::vector<glm::dvec2>& corners);
  void integrate(const Strip& strip);
  void cross(const Edge& edge, double from, double to, double path, std::vector<double>& across) const;
  double path_of(glm::dvec2 p) const { return transmit_.range(p) + receive_.range(p); }
  void integrate(const Cell& cell);
  void halve(const Cell& cell, bool along);
  /// Returns the largest magnitude of value 0.
  double tensor(const Cell& cell, int by_along, int by_across, std::span<double> sum);
  int nodes_for(double extent) const;
  void set_orders(double tolerance);

  const Task* task_ = nullptr;
  const PlanarPolygon* polygon_ = nullptr;
  double tolerance_ = 0;
  std::array<double, most_nodes> largest_{};  // largest extent for which a rule of n + 1 nodes suffices
  // State of the current part. Its middle is the origin of the coordinates along and across.
  glm::dvec2 middle_{0}, along_{1, 0}, across_{0, 1};  // in the polygon's coordinates; the first is an
                                                       // offset
  Over transmit_, receive_;
  double smooth_m_ = 0;    // the part is small compared with these distances
  double rounding_m_ = 0;  // possible displacement of an ellipse by rounding
  double flattest_ = 0;    // lower bound of the path's growth along the gradient
  double steepest_ = 0;    // upper bound of the slope of the ellipses
  std::vector<Edge> edges_;
  std::vector<double> places_, before_, after_, cuts_, values_, inner_, coarse_, fine_;
  int refinements_left_ = 0;
  std::span<double> sample_;
};

}  // namespace tubefoot
