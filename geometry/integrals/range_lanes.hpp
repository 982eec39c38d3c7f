// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>

// Loops of RangeCutter (range_cut.hpp) over the range samples that one edge crosses, several at a time. The
// result for each sample is bitwise that of a separate computation.
namespace tubefoot {

/// A walk along one edge; the names are those of RangeCutter.
struct EdgeWalk {
  double start = 0, height = 0, height2 = 0, range2 = 0, direction = 1;
  glm::dvec2 along{0}, from_foot{0};
  glm::dvec2 from_nearest_point{0}, nearest_from_foot{0};
  double near_range = 0;
};

/// Distances along a line from its nearest point, at `range`, to the points whose range is each of `count`
/// borders. The distance is 0 for borders nearer than `range`.
void distances_to_borders(double range, std::size_t count, const double* borders_m, double* out);

/// Lengths of the stretches [y[k], y[k+1]], and the number of quadrature nodes of each. That number is 0 for
/// a stretch without length and for one that needs more than one quadrature.
void nodes_of_stretches(const EdgeWalk& walk, std::size_t count, const double* y, double* step,
                        double* nodes);

/// The quadrature's nodes and weights on [-1, 1].
struct RuleOfStretches {
  std::size_t nodes = 0;
  const double *x = nullptr, *weight = nullptr;
};

/// The cells of stretches, one per stretch: near ends, and the quotient of the primitive from there on
/// (RadialIntegral::From). `stride` is the distance between consecutive coefficients.
struct CellsOfStretches {
  const double *lo = nullptr, *x0 = nullptr, *per_half = nullptr, *quotient = nullptr;
  std::size_t stride = 0;
  int degree = 0;  ///< highest degree of these cells
};

constexpr std::size_t most_stretches = 64;  ///< at a time

/// Angles of the stretches, and integrals of F dphi over them.
void integrate_stretches(const EdgeWalk& walk, std::size_t count, const double* y, const double* step,
                         const CellsOfStretches& cells, const RuleOfStretches& rule, double* angle,
                         double* inside);

}  // namespace tubefoot
