// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "geometry/integrals/path_cut.hpp"

namespace tubefoot {

/// As PathCutter, for polygons that are small against their distances from both apexes and from the plane's
/// point of shortest path: there the path grows along all parallels to one direction, its gradient in the
/// middle. Cells lie between two curves, edge or ellipse, over an interval across that direction: nothing is
/// turned. If the integrand is analytic, each takes one rule of Gauss-Legendre, whose order follows from its
/// size; else rules of rising order until two agree, or halves.
///
/// Law P4 (compact): what is cut so agrees with cells about the point of shortest path to the tolerance.
class CompactPathCutter {
 public:
  /// What PathCutter::add() is asked for, of one receiver.
  struct Task {
    PathCutter::Receiver receiver;
    const PathCutter::Integrand& integrand;
    const PathCutter::Work& work;
    std::span<const double> borders_m;
    std::span<double> out;
  };
  /// Adds what is compact of the polygon, cut in halves where it is not. What is not after a few times is
  /// appended to `left`, with offsets from the polygon's first corner.
  void add(const PlanarPolygon& polygon, const Task& task, std::vector<PlanarPolygon>& left);

 private:
  static constexpr int most_nodes = 10;

  /// An edge, in coordinates along and across: that end where `across` is least comes first.
  struct Edge {
    glm::dvec2 from, to;
    bool far;  ///< what is inside lies on the side of smaller `along`
    double at(double across) const;
  };
  /// An apex over the plane.
  struct Over {
    double height2 = 0;
    glm::dvec2 foot{0};
    double range(glm::dvec2 p) const;
  };
  /// Edges over an interval across.
  struct Strip {
    const Edge *near, *far;
    double from, to;
  };
  struct Cell {
    const Edge *near, *far;
    double near_path, far_path;  ///< of the ellipse that bounds it there; 0: the edge does
    double from, to;             ///< across
    double begin = 0, end = 1;   ///< of the way from near to far
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
  /// Returns the largest that value 0 was.
  double tensor(const Cell& cell, int by_along, int by_across, std::span<double> sum);
  int nodes_for(double extent) const;
  void set_orders(double tolerance);

  const Task* task_ = nullptr;
  const PlanarPolygon* polygon_ = nullptr;
  double tolerance_ = 0;
  std::array<double, most_nodes> largest_{};  // extent that a rule of n + 1 nodes is enough for
  // Of the part at hand. Coordinates along and across have their origin in its middle.
  glm::dvec2 middle_{0}, along_{1, 0}, across_{0, 1};  // in the polygon's, the first as an offset
  Over transmit_, receive_;
  double smooth_m_ = 0;    // distances are small against this
  double rounding_m_ = 0;  // by which an ellipse may lie elsewhere
  double flattest_ = 0;    // the path grows no slower along
  double steepest_ = 0;    // no ellipse is steeper against across
  std::vector<Edge> edges_;
  std::vector<double> places_, before_, after_, cuts_, values_, inner_, coarse_, fine_;
  int refinements_left_ = 0;
  std::span<double> sample_;
};

}  // namespace tubefoot
