// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/integrals/gauss_rules.hpp"

namespace tubefoot {

/// Density of directions next to an end of an arc, as a function of their cosine w: sum of level[k] (w -
/// origin)^k.
using EndLevels = std::array<double, 4>;

/// Places along the edge of a polygon, with the ends of circles of constant range there.
struct EdgeNodes {
  std::size_t count = 0;  ///< number of nodes; the vectors may be longer
  /// s: coordinate from the edge's nearest point to the apex. `share`: weight of the rule. `middle_m`,
  /// `absorbed`: a range nearby, and the absorption at this range.
  std::vector<double> s, share, middle_m, absorbed;
  std::vector<double> cosine;
  std::array<std::vector<double>, 4> level;
  /// For the gains: panel that contains the cosine, x = (w - middle) per_half, and levels x^k as functions
  /// of x.
  std::vector<std::uint32_t> panel;
  std::vector<double> middle, half, per_half, x;
  std::array<std::vector<double>, 4> own;

  void add(const GaussRule& rule, double at, double to_either_side, double near_m, double absorbed_there);

 private:
  void grow();
};

/// Properties of the edge, the polygon's plane and the array that the nodes require.
struct EdgeLanes {
  static constexpr double largest_absorption = 0.01;  ///< 2 beta |r - middle_m|

  double nearest2 = 0, edge_level = 0, slope = 0;  ///< r^2 = nearest2 + s^2, w = (edge_level + slope s) / r
  double away = 0, steep2 = 0, distance2 = 0;      ///< on the circle of range r: |w - away / r| <= R, with
                                                   ///< R^2 = steep2 (1 - distance2 / r^2)
  double origin = 0, beta = 0, density = 0;
  bool cubic = true;  ///< else the last level is 0
};

/// Computes cosines and levels. The levels are density * share * s r^-6 * absorption, as a cubic, divided by
/// d cosine / d angle. The angle is that about the foot point.
void find_ends(const EdgeLanes& edge, EdgeNodes& nodes);

/// Converts the levels of nodes with known panels to x.
void turn_to_panels(double origin, EdgeNodes& nodes);
/// Adds the integrals of x^i times the levels to row[i], i < 12, from the middle of the panel to the nodes'
/// cosines. The nodes [first, end) belong to one panel. The last level is used only if `cubic`.
void add_end_moments(const EdgeNodes& nodes, std::size_t first, std::size_t end, bool cubic, double* row);

/// Adds the products of the first 12 moments of row k and the f-th of `coefficients` to energy[f * stride +
/// k]. The indices are f < functions and k < count.
void add_received(const double* rows, std::size_t row_size, std::size_t count, const double* coefficients,
                  std::size_t functions, std::size_t stride, double* energy);

}  // namespace tubefoot
