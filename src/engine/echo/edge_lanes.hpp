// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/integrals/gauss_rules.hpp"

namespace tubefoot {

/// What comes from directions next to an end of an arc, by their cosine w: sum of level[k] (w - origin)^k.
using EndLevels = std::array<double, 4>;

/// Places along the edge of a polygon, and the ends there of the circles of constant range.
struct EdgeNodes {
  std::size_t count = 0;  ///< of nodes; vectors are longer
  /// s counts from the edge's nearest point to the apex; `share`: the rule's weight; `middle_m`, `absorbed`:
  /// a range near by, and the absorption there.
  std::vector<double> s, share, middle_m, absorbed;
  std::vector<double> cosine;
  std::array<std::vector<double>, 4> level;
  /// Of the gains: which panel a cosine is in, x = (w - middle) per_half, and levels x^k by x.
  std::vector<std::uint32_t> panel;
  std::vector<double> middle, half, per_half, x;
  std::array<std::vector<double>, 4> own;

  void add(const GaussRule& rule, double at, double to_either_side, double near_m, double absorbed_there);

 private:
  void grow();
};

/// The edge, the polygon's plane and the array, as far as the nodes have to know them.
struct EdgeLanes {
  static constexpr double largest_absorption = 0.01;  ///< 2 beta |r - middle_m|

  double nearest2 = 0, edge_level = 0, slope = 0;  ///< r^2 = nearest2 + s^2, w = (edge_level + slope s) / r
  double away = 0, steep2 = 0, distance2 = 0;      ///< on the circle of range r: |w - away / r| <= R, with
                                                   ///< R^2 = steep2 (1 - distance2 / r^2)
  double origin = 0, beta = 0, density = 0;
  bool cubic = true;  ///< else the last level is 0
};

/// Fills cosines and levels: density share s r^-6 absorption, over the cosine's derivative by the angle about
/// the foot point, as a cubic.
void find_ends(const EdgeLanes& edge, EdgeNodes& nodes);

/// Of nodes whose panels are known.
void turn_to_panels(double origin, EdgeNodes& nodes);
/// Adds to row[i], i < 12, the integrals of x^i and the levels of nodes [first, end), all of one panel, from
/// its middle to their cosines. Without the last level unless `cubic`.
void add_end_moments(const EdgeNodes& nodes, std::size_t first, std::size_t end, bool cubic, double* row);

/// Adds to energy[f * stride + k], f < functions, k < count, the products of the 12 moments that row k begins
/// with and the f-th of `coefficients`.
void add_received(const double* rows, std::size_t row_size, std::size_t count, const double* coefficients,
                  std::size_t functions, std::size_t stride, double* energy);

}  // namespace tubefoot
