// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/polygon_gradient.hpp"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <glm/geometric.hpp>

#include "geometry/numbers/scalars.hpp"

// Integrates along the edges of polygons between range circles, with Gauss rules on intervals. The integrands
// have their poles near the point of the line that is nearest to the apex. From this point on, the intervals
// double in length.

namespace tubefoot {
namespace {

using Rule = boost::math::quadrature::gauss<double, 20>;

/// Calls use(node, weight) for the nodes of a Gauss rule on [from, to].
template <class Use>
void at_nodes(double from, double to, const Use& use) {
  const double middle = (from + to) / 2, half = (to - from) / 2;
  const auto& nodes = Rule::abscissa();
  const auto& weights = Rule::weights();
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    use(middle + half * nodes[k], half * weights[k]);
    if (nodes[k] != 0) use(middle - half * nodes[k], half * weights[k]);
  }
}

}  // namespace

void PolygonGradient::add(const PlanarPolygon& polygon, const std::function<double(double)>& density,
                          const std::function<void(const Part&)>& sink) {
  const double distance = polygon.distance, last = borders_.back();
  const std::size_t corners = polygon.offsets.size();
  // Returns the bin that contains a range, or the number of bins.
  const auto bin_of = [&](double r) {
    if (r < borders_.front() || r >= last) return borders_.size() - 1;
    return std::size_t(std::upper_bound(borders_.begin(), borders_.end(), r) - borders_.begin()) - 1;
  };
  const std::size_t none = borders_.size() - 1, foot_bin = bin_of(distance);
  const double at_foot = foot_bin != none ? density(distance) : 0;
  for (std::size_t edge = 0; edge < corners; ++edge) {
    const glm::dvec2 first = polygon.corner(edge);
    const glm::dvec2 along = polygon.offsets[(edge + 1) % corners] - polygon.offsets[edge];
    const double length = glm::length(along);
    if (!(length > 0)) continue;
    const glm::dvec2 unit = along / length;
    const double begin = glm::dot(first, unit), end = begin + length;
    const double aside = cross(first, unit);  // signed distance of the edge's line from the foot point
    const double nearest = std::hypot(distance, aside);
    breaks_.assign({begin, end});
    const auto cut = [&](double x) {
      for (const double place : {-x, x})
        if (place > begin && place < end) breaks_.push_back(place);
    };
    for (const double border : borders_)
      if (border > nearest) cut(std::sqrt((border - nearest) * (border + nearest)));
    const double farthest = std::max(std::abs(begin), std::abs(end));
    cut(0);
    for (const double scale : {nearest, std::abs(aside)})
      if (scale > 1e-12 * farthest)
        for (double x = scale / 2; x < farthest; x *= 2) cut(x);
    std::sort(breaks_.begin(), breaks_.end());
    const glm::dvec2 outward(unit.y, -unit.x);
    for (std::size_t k = 0; k + 1 < breaks_.size(); ++k) {
      const double from = breaks_[k], to = breaks_[k + 1];
      if (!(to > from)) continue;
      const std::size_t bin = bin_of(std::hypot(nearest, (from + to) / 2));
      Part part{bin, edge};
      if (bin != none) {
        double whole = 0, second = 0, turned = 0;
        at_nodes(from, to, [&](double x, double weight) {
          const double f = density(std::hypot(nearest, x));
          whole += weight * f;
          second += weight * f * (x - begin) / length;
          const double square = aside * aside + x * x;
          if (square > 0) turned += weight * (bin == foot_bin ? f - at_foot : f) * aside / square;
        });
        part.by_first = (whole - second) * outward;
        part.by_second = second * outward;
        part.by_distance = distance * turned;
        sink(part);
      }
      if (bin != foot_bin && foot_bin != none && aside != 0) {
        const double angle = std::atan2(aside * (to - from), aside * aside + from * to);
        sink({foot_bin, edge, glm::dvec2(0), glm::dvec2(0), -distance * at_foot * angle});
      }
    }
  }
}

}  // namespace tubefoot
