// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/surface_scatterers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/integrals/gauss_rules.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

int nodes_for(double change_rad, double tolerance) {
  int nodes = 1;
  while (nodes < most_rule_nodes && gauss_error(nodes, change_rad) > tolerance) ++nodes;
  return nodes;
}

}  // namespace

double gauss_error(int nodes, double change_rad) {
  // f^(2n) 2^(2n+1) (n!)^4 / ((2n + 1) ((2n)!)^3), relative to the length 2.
  double error = 1.0 / (2 * nodes + 1);
  for (int k = 1; k <= nodes; ++k) error *= 4.0 * k * k * k * k;
  for (int k = 1; k <= 2 * nodes; ++k) error *= change_rad / (double(k) * k * k);
  return error;
}

std::vector<SurfaceScatterer> seabed_scatterers(const VisiblePolygons& seen, const SignalExtent& extent,
                                                double tolerance) {
  if (!(tolerance > 0 && tolerance < 1))
    throw std::invalid_argument(fmt::format("the tolerance must be between 0 and 1, not {}", tolerance));
  if (extent.transmit_m.empty() || extent.receive_m.empty())
    throw std::invalid_argument("signals need a transmitter and at least one receiver");
  double most_change = 0.25;
  while (gauss_error(most_rule_nodes, most_change * 1.05) <= tolerance) most_change *= 1.05;
  const SmoothPieces pieces(extent, most_change);
  std::vector<SurfaceScatterer> all;
  std::vector<SmoothPieces::Chunk> chunks;
  for (std::uint32_t number = 0; number < seen.patches.size(); ++number) {
    stop_if_wanted();
    chunks.clear();
    pieces.cut(seen, seen.patches[number], chunks);
    for (const SmoothPieces::Chunk& chunk : chunks) {
      const GaussRule &by_u = gauss_rule(nodes_for(chunk.change_u, tolerance)),
                      &by_v = gauss_rule(nodes_for(chunk.change_v, tolerance)),
                      &by_both = by_u.node.size() > by_v.node.size() ? by_u : by_v;
      SmoothPieces::for_rectangles(chunk, [&](int i, int j, std::span<const glm::dvec2> polygon, bool whole) {
        if (whole) {
          const glm::dvec3 middle = chunk.middle_m(i, j), u = chunk.size_m.x / 2 * chunk.u,
                           v = chunk.size_m.y / 2 * chunk.v;
          const double area = chunk.size_m.x * chunk.size_m.y / 4;
          for (std::size_t a = 0; a < by_u.node.size(); ++a)
            for (std::size_t b = 0; b < by_v.node.size(); ++b)
              all.push_back({middle + by_u.node[a] * u + by_v.node[b] * v,
                             area * by_u.weight[a] * by_v.weight[b], number});
          return;
        }
        // Bilinear maps of quadrilaterals from the first corner on. The last one may be a triangle.
        for (std::size_t k = 1; k + 1 < polygon.size(); k += 2) {
          const glm::dvec2 c0 = polygon[0], c1 = polygon[k], c2 = polygon[k + 1],
                           c3 = k + 2 < polygon.size() ? polygon[k + 2] : c2;
          for (std::size_t a = 0; a < by_both.node.size(); ++a)
            for (std::size_t b = 0; b < by_both.node.size(); ++b) {
              const double s = (1 + by_both.node[a]) / 2, t = (1 + by_both.node[b]) / 2;
              const glm::dvec2 by_s = (1 - t) * (c1 - c0) + t * (c2 - c3),
                               by_t = (1 - s) * (c3 - c0) + s * (c2 - c1);
              const double weight =
                  (by_s.x * by_t.y - by_s.y * by_t.x) * by_both.weight[a] * by_both.weight[b] / 4;
              if (weight > 0) all.push_back({chunk.at(c0 + s * (c1 - c0) + t * by_t), weight, number});
            }
        }
      });
    }
  }
  return all;
}

}  // namespace tubefoot
