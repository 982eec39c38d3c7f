// SPDX-License-Identifier: GPL-3.0-or-later
#include "propagation/ray_path.hpp"

#include <algorithm>
#include <cmath>

namespace tubefoot {

std::vector<PathPoint> points_along(const std::vector<RayNode>& nodes, double step_rad) {
  std::vector<PathPoint> points;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const RayState& to = nodes[k].state;
    const double angle_to = std::atan2(to.sine, to.cosine);
    if (k > 0) {
      const RayState& from = nodes[k - 1].state;
      const bool reflected = nodes[k].event == RayEvent::surface || nodes[k].event == RayEvent::bottom;
      const double a = std::atan2(from.sine, from.cosine), b = reflected ? -angle_to : angle_to;
      const double sine_a = std::sin(a), sine_b = std::sin(b);
      const int pieces = static_cast<int>(std::min(1e4, std::ceil(std::abs(b - a) / step_rad)));
      for (int i = 1; i < pieces; ++i) {
        const double angle = a + (b - a) * i / pieces, sine = std::sin(angle);
        const double by_range = (sine - sine_a) / (sine_b - sine_a),
                     by_angle = static_cast<double>(i) / pieces;
        const double by_time =
            (std::atanh(sine) - std::atanh(sine_a)) / (std::atanh(sine_b) - std::atanh(sine_a));
        const auto at = [](double first, double last, double part) { return first + (last - first) * part; };
        // The depth is the integral of the tangent over the range.
        const double depth_m =
            from.depth_m + (to.range_m - from.range_m) * (std::cos(a) - std::cos(angle)) / (sine_b - sine_a);
        points.push_back({nullptr, at(from.range_m, to.range_m, by_range), depth_m, angle,
                          at(from.time_s, to.time_s, by_time), at(from.length_m, to.length_m, by_angle),
                          at(from.absorption_db, to.absorption_db, by_angle)});
      }
    }
    points.push_back({&nodes[k], to.range_m, to.depth_m, angle_to, to.time_s, to.length_m, to.absorption_db});
  }
  return points;
}

}  // namespace tubefoot
