// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/edge_lanes.hpp"

#include <cmath>
#include <cstring>

#include "geometry/numbers/vector_clones.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t lanes = 4;
using Four = double __attribute__((vector_size(32)));

/// Integral of x^i x^k from 0 to x is x^(i + k + 1) / (i + k + 1): by i, over that of k = 0.
struct Antiderivatives {
  std::array<double, 12> reciprocal{}, first{}, second{}, third{};
  constexpr Antiderivatives() {
    for (int i = 0; i < 12; ++i) {
      reciprocal[i] = 1.0 / (i + 1);
      first[i] = double(i + 1) / (i + 2);
      second[i] = double(i + 1) / (i + 3);
      third[i] = double(i + 1) / (i + 4);
    }
  }
};
constexpr Antiderivatives of;

TUBEFOOT_VECTOR_CLONES
void ends_of(const EdgeLanes& given, std::size_t count, const double* __restrict s,
             const double* __restrict share, const double* __restrict middle,
             const double* __restrict absorbed, double* __restrict cosine, double* __restrict level0,
             double* __restrict level1, double* __restrict level2, double* __restrict level3) {
  const EdgeLanes edge = given;
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
    level3[k] = level * bend * (1.5 * per_root2 + 2.5 * bend2);
  }
}

TUBEFOOT_VECTOR_CLONES
void own_of(double origin, std::size_t count, const double* __restrict cosine,
            const double* __restrict middle, const double* __restrict per_half,
            const double* __restrict level0, const double* __restrict level1, const double* __restrict level2,
            const double* __restrict level3, double* __restrict x, double* __restrict own0,
            double* __restrict own1, double* __restrict own2, double* __restrict own3) {
  for (std::size_t k = 0; k < count; ++k) {
    const double away = middle[k] - origin, half = 1 / per_half[k];
    x[k] = (cosine[k] - middle[k]) * per_half[k];
    const double step = half * x[k], third = 3 * away * level3[k];
    own0[k] = half * (level0[k] + away * (level1[k] + away * (level2[k] + away * level3[k])));
    own1[k] = half * step * (level1[k] + away * (2 * level2[k] + third));
    own2[k] = half * (step * step) * (level2[k] + third);
    own3[k] = half * (step * step) * step * level3[k];
  }
}

TUBEFOOT_VECTOR_CLONES
void moments_of(std::size_t count, const double* at, const double* own0, const double* own1,
                const double* own2, const double* own3, double* row) {
  Four first[3], second[3], third[3], moment[3] = {};
  std::memcpy(first, of.first.data(), sizeof first);
  std::memcpy(second, of.second.data(), sizeof second);
  std::memcpy(third, of.third.data(), sizeof third);
  for (std::size_t k = 0; k < count; ++k) {
    const double x = at[k], x2 = x * x, x4 = x2 * x2;
    Four power{x, x2, x2 * x, x4};
    for (int j = 0; j < 3; ++j) {
      moment[j] += power * (own0[k] + first[j] * own1[k] + second[j] * own2[k] + third[j] * own3[k]);
      power *= x4;
    }
  }
  Four reciprocal[3], old[3];
  std::memcpy(reciprocal, of.reciprocal.data(), sizeof reciprocal);
  std::memcpy(old, row, sizeof old);
  for (int j = 0; j < 3; ++j) old[j] += moment[j] * reciprocal[j];
  std::memcpy(row, old, sizeof old);
}

/// So that whole lanes may be worked on.
std::size_t padded(std::size_t count) { return (count + lanes - 1) / lanes * lanes; }

}  // namespace

void EdgeNodes::grow() {
  const std::size_t size = 2 * s.size() + 64;
  for (std::vector<double>* numbers : {&s, &share, &middle_m, &absorbed, &cosine, &middle, &per_half, &x})
    numbers->resize(size, 1);
  for (std::size_t k = 0; k < level.size(); ++k) {
    level[k].resize(size);
    own[k].resize(size);
  }
  panel.resize(size);
}

void EdgeNodes::add(const GaussRule& rule, double at, double half, double near_m, double absorbed_there) {
  const std::size_t nodes = rule.node.size();
  while (count + nodes + lanes > s.size()) grow();
  for (std::size_t i = 0; i < nodes; ++i, ++count) {
    s[count] = at + half * rule.node[i];
    share[count] = half * rule.weight[i];
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
  own_of(origin, padded(nodes.count), nodes.cosine.data(), nodes.middle.data(), nodes.per_half.data(),
         nodes.level[0].data(), nodes.level[1].data(), nodes.level[2].data(), nodes.level[3].data(),
         nodes.x.data(), nodes.own[0].data(), nodes.own[1].data(), nodes.own[2].data(), nodes.own[3].data());
}

void add_end_moments(const EdgeNodes& nodes, std::size_t first, std::size_t end, double* row) {
  moments_of(end - first, nodes.x.data() + first, nodes.own[0].data() + first, nodes.own[1].data() + first,
             nodes.own[2].data() + first, nodes.own[3].data() + first, row);
}

}  // namespace tubefoot
