// SPDX-License-Identifier: GPL-3.0-or-later
// Loops of RangeCutter over the stretches of one edge, one stretch per range cell, in a form that the
// compiler vectorises. Each stretch has the digits that a computation of that stretch alone would give.

#include "geometry/integrals/range_lanes.hpp"

#include <array>
#include <cmath>

#include "geometry/numbers/vector_clones.hpp"

namespace tubefoot {
namespace {

TUBEFOOT_VECTOR_CLONES
void distances(double range, std::size_t count, const double* __restrict border, double* __restrict out) {
  for (std::size_t k = 0; k < count; ++k) {
    const double square = (border[k] - range) * (border[k] + range);
    out[k] = std::sqrt(square < 0 ? 0.0 : square);
  }
}

TUBEFOOT_VECTOR_CLONES
void nodes_of(double start, double height2, std::size_t count, const double* __restrict y,
              double* __restrict step, double* __restrict nodes) {
  for (std::size_t k = 0; k < count; ++k) {
    const double s = start + y[k], distance = std::sqrt(s * s + height2);
    const double rest = std::abs(y[k + 1] - y[k]);
    const double whole = rest < distance / 2 ? rest : distance / 2;
    step[k] = rest - whole < whole / 4 ? rest : whole;
    const double rule = step[k] <= 0.006 * distance  ? 3
                        : step[k] <= 0.03 * distance ? 4
                        : step[k] <= 0.08 * distance ? 5
                                                     : 8;
    nodes[k] = step[k] == rest && rest > 0 ? rule : 0;
  }
}

/// One node of each stretch: the angle that the node represents, and its distance from the near end of its
/// cell.
[[gnu::always_inline]] inline void nodes_at(const EdgeWalk& walk, double node, double weight,
                                            std::size_t count, const double* __restrict y,
                                            const double* __restrict step, const double* __restrict lo,
                                            const double* __restrict x0, const double* __restrict per_half,
                                            double* __restrict turned, double* __restrict x,
                                            double* __restrict scaled) {
  const double start = walk.start, height2 = walk.height2, range2 = walk.range2, direction = walk.direction;
  const double weighed_height = weight * walk.height, near_range = walk.near_range;
  const double along_x = walk.along.x, along_y = walk.along.y, foot_x = walk.from_foot.x,
               foot_y = walk.from_foot.y, nearest_x = walk.from_nearest_point.x,
               nearest_y = walk.from_nearest_point.y, to_nearest_x = walk.nearest_from_foot.x,
               to_nearest_y = walk.nearest_from_foot.y;
  for (std::size_t k = 0; k < count; ++k) {
    const double half = direction * step[k] / 2, centre = y[k] + half;
    const double along = centre + half * node, at = start + along, at2 = at * at;
    turned[k] = step[k] / 2 * (weighed_height / (height2 + at2));
    const double range = std::sqrt(range2 + at2);
    const double reach_x = along * along_x, reach_y = along * along_y;
    const double gain = ((nearest_x + reach_x) * (foot_x + reach_x + to_nearest_x) +
                         (nearest_y + reach_y) * (foot_y + reach_y + to_nearest_y)) /
                            (range + near_range) -
                        (lo[k] - near_range);
    scaled[k] = gain * per_half[k];
    x[k] = x0[k] + scaled[k];
  }
}

/// Horner's scheme. Coefficients beyond a quotient's own degree are 0 and change nothing.
[[gnu::always_inline]] inline void quotients(int degree, std::size_t count,
                                             const double* __restrict coefficients, std::size_t stride,
                                             const double* __restrict x, double* __restrict out) {
  for (std::size_t k = 0; k < count; ++k) out[k] = 0;
  for (int i = degree; i-- > 0;) {
    const double* __restrict coefficient = coefficients + std::size_t(i) * stride;
    for (std::size_t k = 0; k < count; ++k) out[k] = out[k] * x[k] + coefficient[k];
  }
}

TUBEFOOT_VECTOR_CLONES
void integrals(const EdgeWalk& walk, std::size_t count, const double* __restrict y,
               const double* __restrict step, const CellsOfStretches& cells, const RuleOfStretches& rule,
               double* __restrict angle, double* __restrict inside) {
  alignas(64) std::array<double, most_stretches> turned, x, scaled, quotient;
  for (std::size_t k = 0; k < count; ++k) angle[k] = inside[k] = 0;
  for (std::size_t i = 0; i < rule.nodes; ++i) {
    nodes_at(walk, rule.x[i], rule.weight[i], count, y, step, cells.lo, cells.x0, cells.per_half,
             turned.data(), x.data(), scaled.data());
    quotients(cells.degree, count, cells.quotient, cells.stride, x.data(), quotient.data());
    for (std::size_t k = 0; k < count; ++k) {
      angle[k] += turned[k];
      inside[k] += turned[k] * (scaled[k] * quotient[k]);
    }
  }
}

}  // namespace

void distances_to_borders(double range, std::size_t count, const double* borders_m, double* out) {
  distances(range, count, borders_m, out);
}

void nodes_of_stretches(const EdgeWalk& walk, std::size_t count, const double* y, double* step,
                        double* nodes) {
  nodes_of(walk.start, walk.height2, count, y, step, nodes);
}

void integrate_stretches(const EdgeWalk& walk, std::size_t count, const double* y, const double* step,
                         const CellsOfStretches& cells, const RuleOfStretches& rule, double* angle,
                         double* inside) {
  integrals(walk, count, y, step, cells, rule, angle, inside);
}

}  // namespace tubefoot
