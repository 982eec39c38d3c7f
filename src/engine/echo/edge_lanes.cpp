// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/edge_lanes.hpp"

#include <cmath>

#include "engine/echo/antiderivatives.hpp"
#include "geometry/numbers/vector_clones.hpp"

// Evaluates edge nodes of PatternIntegrator in vectors of four doubles: ends of arcs, levels of their
// densities, and moments by antiderivatives (edge_lanes.hpp).

namespace tubefoot {
namespace {

constexpr std::size_t lanes = 4;
using Four = double __attribute__((vector_size(32)));
/// Four doubles at an unaligned address. (memcpy may copy by halves. Reading them as a whole would then take
/// longer than all sums.)
using FourThere = double __attribute__((vector_size(32), aligned(8), may_alias));

const FourThere* fours(const double* numbers) { return reinterpret_cast<const FourThere*>(numbers); }
FourThere* fours(double* numbers) { return reinterpret_cast<FourThere*>(numbers); }

constexpr Antiderivatives<12> of;

TUBEFOOT_VECTOR_CLONES
void ends_of(const EdgeLanes& given, std::size_t count, const double* __restrict s,
             const double* __restrict share, const double* __restrict middle,
             const double* __restrict absorbed, double* __restrict cosine, double* __restrict level0,
             double* __restrict level1, double* __restrict level2, double* __restrict level3) {
  const EdgeLanes edge = given;
  const double cubic = edge.cubic ? 1 : 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double r2 = edge.nearest2 + s[k] * s[k], over_r = 1 / std::sqrt(r2), over_r2 = over_r * over_r;
    cosine[k] = (edge.edge_level + edge.slope * s[k]) * over_r;
    const double x = 2 * edge.beta * (middle[k] - r2 * over_r);
    const double nearby = 1 + x * (1 + x * (1.0 / 2 + x * (1.0 / 6 + x * (1.0 / 24 + x * (1.0 / 120)))));
    const double radial =
        edge.density * share[k] * s[k] * (absorbed[k] * nearby) * (over_r2 * over_r2 * over_r2);
    const double c = edge.origin - edge.away * over_r;
    const double per_root2 = 1 / (edge.steep2 * (1 - edge.distance2 * over_r2) - c * c);
    const double bend = c * per_root2, bend2 = bend * bend, level = radial * std::sqrt(per_root2);
    level0[k] = level;
    level1[k] = level * bend;
    level2[k] = level * (per_root2 / 2 + 1.5 * bend2);
    level3[k] = cubic * level * bend * (1.5 * per_root2 + 2.5 * bend2);
  }
}

TUBEFOOT_VECTOR_CLONES
void own_of(double origin, std::size_t count, const double* __restrict cosine,
            const double* __restrict middle, const double* __restrict half, const double* __restrict per_half,
            const double* __restrict level0, const double* __restrict level1, const double* __restrict level2,
            const double* __restrict level3, double* __restrict x, double* __restrict own0,
            double* __restrict own1, double* __restrict own2, double* __restrict own3) {
  for (std::size_t k = 0; k < count; ++k) {
    const double away = middle[k] - origin;
    x[k] = (cosine[k] - middle[k]) * per_half[k];
    const double step = half[k] * x[k], third = 3 * away * level3[k];
    own0[k] = half[k] * (level0[k] + away * (level1[k] + away * (level2[k] + away * level3[k])));
    own1[k] = half[k] * step * (level1[k] + away * (2 * level2[k] + third));
    own2[k] = half[k] * (step * step) * (level2[k] + third);
    own3[k] = half[k] * (step * step) * step * level3[k];
  }
}

TUBEFOOT_VECTOR_CLONES
void moments_of(std::size_t count, const double* at, const double* own0, const double* own1,
                const double* own2, const double* own3, double* row) {
  const FourThere *first = fours(of.first.data()), *second = fours(of.second.data()),
                  *third = fours(of.third.data()), *reciprocal = fours(of.reciprocal.data());
  Four moment[3] = {};
  for (std::size_t k = 0; k < count; ++k) {
    const double x = at[k], x2 = x * x, x4 = x2 * x2;
    Four power{x, x2, x2 * x, x4};
    for (int j = 0; j < 3; ++j) {
      moment[j] += power * (own0[k] + first[j] * own1[k] + second[j] * own2[k] + third[j] * own3[k]);
      power *= x4;
    }
  }
  FourThere* sums = fours(row);
  for (int j = 0; j < 3; ++j) sums[j] += moment[j] * reciprocal[j];
}

/// The same without the last level.
TUBEFOOT_VECTOR_CLONES
void moments_of_quadratics(std::size_t count, const double* at, const double* own0, const double* own1,
                           const double* own2, double* row) {
  const FourThere *first = fours(of.first.data()), *second = fours(of.second.data()),
                  *reciprocal = fours(of.reciprocal.data());
  Four moment[3] = {};
  for (std::size_t k = 0; k < count; ++k) {
    const double x = at[k], x2 = x * x, x4 = x2 * x2;
    Four power{x, x2, x2 * x, x4};
    for (int j = 0; j < 3; ++j) {
      moment[j] += power * (own0[k] + first[j] * own1[k] + second[j] * own2[k]);
      power *= x4;
    }
  }
  FourThere* sums = fours(row);
  for (int j = 0; j < 3; ++j) sums[j] += moment[j] * reciprocal[j];
}

TUBEFOOT_VECTOR_CLONES
void received_of(const double* rows, std::size_t row_size, std::size_t count, const double* coefficients,
                 std::size_t functions, std::size_t stride, double* energy) {
  for (std::size_t f = 0; f < functions; ++f) {
    const FourThere* own = fours(coefficients + 12 * f);
    const Four own0 = own[0], own1 = own[1], own2 = own[2];
    for (std::size_t k = 0; k < count; ++k) {
      const FourThere* moment = fours(rows + row_size * k);
      const Four sum = own0 * moment[0] + own1 * moment[1] + own2 * moment[2];
      energy[f * stride + k] += (sum[0] + sum[2]) + (sum[1] + sum[3]);
    }
  }
}

/// Rounds up to a multiple of the vector length.
std::size_t padded(std::size_t count) { return (count + lanes - 1) / lanes * lanes; }

}  // namespace

void EdgeNodes::grow() {
  const std::size_t size = 2 * s.size() + 64;
  for (std::vector<double>* numbers :
       {&s, &share, &middle_m, &absorbed, &cosine, &middle, &half, &per_half, &x})
    numbers->resize(size, 1);
  for (std::size_t k = 0; k < level.size(); ++k) {
    level[k].resize(size);
    own[k].resize(size);
  }
  panel.resize(size);
}

void EdgeNodes::add(const GaussRule& rule, double at, double to_either_side, double near_m,
                    double absorbed_there) {
  const std::size_t nodes = rule.node.size();
  while (count + nodes + lanes > s.size()) grow();
  for (std::size_t i = 0; i < nodes; ++i, ++count) {
    s[count] = at + to_either_side * rule.node[i];
    share[count] = to_either_side * rule.weight[i];
    middle_m[count] = near_m;
    absorbed[count] = absorbed_there;
  }
}

void find_ends(const EdgeLanes& edge, EdgeNodes& nodes) {
  ends_of(edge, padded(nodes.count), nodes.s.data(), nodes.share.data(), nodes.middle_m.data(),
          nodes.absorbed.data(), nodes.cosine.data(), nodes.level[0].data(), nodes.level[1].data(),
          nodes.level[2].data(), nodes.level[3].data());
}

void turn_to_panels(double origin, EdgeNodes& nodes) {
  own_of(origin, padded(nodes.count), nodes.cosine.data(), nodes.middle.data(), nodes.half.data(),
         nodes.per_half.data(), nodes.level[0].data(), nodes.level[1].data(), nodes.level[2].data(),
         nodes.level[3].data(), nodes.x.data(), nodes.own[0].data(), nodes.own[1].data(), nodes.own[2].data(),
         nodes.own[3].data());
}

void add_end_moments(const EdgeNodes& nodes, std::size_t first, std::size_t end, bool cubic, double* row) {
  const double *x = nodes.x.data() + first, *own0 = nodes.own[0].data() + first,
               *own1 = nodes.own[1].data() + first, *own2 = nodes.own[2].data() + first;
  if (cubic)
    moments_of(end - first, x, own0, own1, own2, nodes.own[3].data() + first, row);
  else
    moments_of_quadratics(end - first, x, own0, own1, own2, row);
}

void add_received(const double* rows, std::size_t row_size, std::size_t count, const double* coefficients,
                  std::size_t functions, std::size_t stride, double* energy) {
  received_of(rows, row_size, count, coefficients, functions, stride, energy);
}

}  // namespace tubefoot
