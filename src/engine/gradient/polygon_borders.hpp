// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "geometry/integrals/gauss_rules.hpp"
#include "geometry/integrals/measure.hpp"

// Quadrature along the borders of the parts of a polygon that lie in range bins: stretches of its edges, and
// arcs of range circles. A Gauss rule integrates each stretch. Its order follows from the distance of the
// integrand's singularities, by the ellipse of analyticity.
namespace tubefoot {

/// Ranges at which bins begin and end, and further ranges at which an integrand has kinks. Both divide ranges
/// into cells.
struct RangeCells {
  static constexpr std::size_t none = std::size_t(-1);
  std::vector<double> borders;           ///< increasing
  std::vector<std::size_t> bin_of_cell;  ///< one less than borders

  RangeCells() = default;
  RangeCells(std::span<const double> bin_borders, std::span<const double> kinks);
  std::size_t size() const { return bin_of_cell.size(); }
  /// Returns the first border above a range.
  std::size_t border_above(double range) const;
  /// Returns the cell that contains a range, or `none`.
  std::size_t cell_at(double range) const;
};

/// Points p of a plane at range r with along . p + at_foot = cosine r.
struct PlaneCone {
  glm::dvec2 along{0};
  double at_foot = 0, cosine = 0;
};

/// Smoothness of an integrand on a plane.
struct BorderSmoothness {
  double tolerance = 1e-15;
  double angle_rad = 1;  ///< angle at the apex over which the integrand grows by at most e^3 (Smoothness)
  bool pointed = false;  ///< singular at the foot point
  int degree = 0;        ///< of a polynomial of position that multiplies the integrand
  /// Appends the shares of a line, in 0 .. 1, at which the integrand is not analytic.
  std::function<void(glm::dvec2 from, glm::dvec2 to, std::vector<double>& shares)> breaks{};
  std::vector<PlaneCone> kinks{};  ///< at which the integrand is not analytic
};

/// A part of an edge in one range cell. Points are at first + (x - begin) unit.
struct EdgeStretch {
  std::size_t edge = 0, cell = 0;  ///< RangeCells::none outside
  glm::dvec2 first{0}, unit{0};
  double begin = 0, length = 0;   ///< of the edge; x is 0 at the point that is nearest to the foot point
  double aside = 0, nearest = 0;  ///< signed distance of the line from the foot point; range of the line
  double from = 0, to = 0;
  const GaussRule* rule = nullptr;

  /// Angle of the stretch as seen from the foot point.
  double angle() const;
  /// Calls use(x, weight, point).
  template <class Use>
  void at_nodes(const Use& use) const {
    const double middle = (from + to) / 2, half = (to - from) / 2;
    for (std::size_t k = 0; k < rule->node.size(); ++k) {
      const double x = middle + half * rule->node[k];
      use(x, half * rule->weight[k], first + (x - begin) * unit);
    }
  }
  glm::dvec2 outward() const { return {unit.y, -unit.x}; }
};

/// A part of a range circle inside of a polygon.
struct CircleArc {
  std::size_t border = 0;  ///< of the range cells
  double radius = 0, from = 0, to = 0;
  const GaussRule* rule = nullptr;
};

/// Finds stretches and arcs. An object contains scratch memory: use one per thread.
class PolygonBorders {
 public:
  /// Calls `use` with all stretches of a polygon's edges in the order of the edges.
  void edges(const PlanarPolygon& polygon, const RangeCells& cells, const BorderSmoothness& smooth,
             const std::function<void(const EdgeStretch&)>& use);
  /// Calls `use` with all arcs of circles at borders of bins inside of a convex polygon.
  void arcs(const PlanarPolygon& polygon, const RangeCells& cells, const BorderSmoothness& smooth,
            const std::function<void(const CircleArc&)>& use);

 private:
  void cut(EdgeStretch& stretch, double from, double to, const BorderSmoothness& smooth,
           const std::function<void(const EdgeStretch&)>& use) const;
  std::vector<double> breaks_, shares_, angles_;
};

}  // namespace tubefoot
