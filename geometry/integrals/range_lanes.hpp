// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>

// Loops of RangeCutter (range_cut.hpp) over the range samples that one edge crosses, several at a time. Each
// sample's digits are those that it has by itself.
namespace tubefoot {

/// Along a walk on one edge, in the names of RangeCutter.
struct EdgeWalk {
  double start = 0, height = 0, height2 = 0, range2 = 0, direction = 1;
  glm::dvec2 along{0}, from_foot{0};
  glm::dvec2 from_nearest_point{0}, nearest_from_foot{0};
  double near_range = 0;
};

/// Distances along a line from its nearest point, at `range`, to where its range is each of `count` borders:
/// 0 for those that are nearer.
void distances_to_borders(double range, std::size_t count, const double* borders_m, double* out);

/// Of stretches [y[k], y[k+1]]: their lengths, and how many nodes the quadrature over each takes; 0 where it
/// has no length or takes more than one quadrature.
void nodes_of_stretches(const EdgeWalk& walk, std::size_t count, const double* y, double* step,
                        double* nodes);

/// The quadrature's nodes and weights on [-1, 1].
struct RuleOfStretches {
  std::size_t nodes = 0;
  const double *x = nullptr, *weight = nullptr;
};

/// Cells that stretches lie in, one each, by cell: near ends, and the primitive's quotient from there on
/// (RadialIntegral::From), its coefficients `stride` apart.
struct CellsOfStretches {
  const double *lo = nullptr, *x0 = nullptr, *per_half = nullptr, *quotient = nullptr;
  std::size_t stride = 0;
  int degree = 0;  ///< the highest of them
};

constexpr std::size_t most_stretches = 64;  ///< at a time

/// Their angles and integrals of F dphi.
void integrate_stretches(const EdgeWalk& walk, std::size_t count, const double* y, const double* step,
                         const CellsOfStretches& cells, const RuleOfStretches& rule, double* angle,
                         double* inside);

}  // namespace tubefoot
