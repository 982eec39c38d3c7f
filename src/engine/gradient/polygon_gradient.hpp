// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <glm/vec2.hpp>
#include <span>
#include <utility>
#include <vector>

#include "geometry/integrals/measure.hpp"

namespace tubefoot {

/// Derivatives of integrals of a function of range over a planar polygon, by range bin. Let
///     E_k(corners, D) = integral of f(r) dA over the polygon and the ranges r_k <= r < r_k+1,
/// in coordinates of the plane about the foot point of the apex, at distance D from the plane. By Reynolds'
/// transport theorem the derivative by a corner is the integral of f times the normal velocity along both of
/// its edges. In polar coordinates about the foot point, E_k is a line integral of F(r) - F(D) over the
/// polar angle, with dF/dr = f r. The derivative by D, at fixed corners and fixed f, is therefore
///     dE_k/dD = D (line integral of f(r) [r in bin k] - f(D) [D in bin k] over the polar angle).
class PolygonGradient {
 public:
  /// `borders_m`: increasing, one more than bins.
  explicit PolygonGradient(std::vector<double> borders_m) : borders_(std::move(borders_m)) {}

  /// The part of one edge in one range bin.
  struct Part {
    std::size_t bin = 0, edge = 0;         ///< edge k joins corner k and corner k + 1
    glm::dvec2 by_first{0}, by_second{0};  ///< derivatives by the corners of the edge
    double by_distance = 0;
  };
  /// Calls `sink` with all parts that are not 0. `density`: f. Relative error of a part: about 1e-14 of the
  /// largest part, for functions that are smooth on the scale of r.
  void add(const PlanarPolygon& polygon, const std::function<double(double)>& density,
           const std::function<void(const Part&)>& sink);

 private:
  std::vector<double> borders_, breaks_;
};

}  // namespace tubefoot
