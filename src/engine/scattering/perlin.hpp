// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace tubefoot {

/// The lattice of improved Perlin noise (K. Perlin, Improving Noise, SIGGRAPH 2002). In each unit cell the
/// noise is a polynomial of degree 6 in each coordinate. At every corner it is zero, with a gradient along a
/// cube's edge. It is twice continuously differentiable across cells and repeats after 256 cells.
class PerlinLattice {
 public:
  /// Seed 0 gives the reference permutation; any other seed shuffles it.
  explicit PerlinLattice(std::uint64_t seed = 0);

  /// Bound of the noise's magnitude: 1.03635381 at a cell's (0.48149, 0.5, 0.64474).
  static constexpr double largest = 1.036354;

  double operator()(double x, double y, double z) const;

  /// Evaluates the polynomial of the cell whose lowest corner is (i, j, k), at x, y, z in 0 .. 1 relative to
  /// the corner. `N` is double or another type with addition and multiplication (balls, complex balls).
  template <class N>
  N in_cell(std::int64_t i, std::int64_t j, std::int64_t k, const N& x, const N& y, const N& z) const {
    const N u = fade(x), v = fade(y), w = fade(z);
    const std::array<N, 2> along_x{x, x - N(1)}, along_y{y, y - N(1)}, along_z{z, z - N(1)};
    std::array<N, 2> planes;
    for (unsigned c = 0; c < 2; ++c) {
      std::array<N, 2> rows;
      for (unsigned b = 0; b < 2; ++b) {
        const N low = corner(i, j + b, k + c, along_x[0], along_y[b], along_z[c]);
        const N high = corner(i + 1, j + b, k + c, along_x[1], along_y[b], along_z[c]);
        rows[b] = low + u * (high - low);
      }
      planes[c] = rows[0] + v * (rows[1] - rows[0]);
    }
    return planes[0] + w * (planes[1] - planes[0]);
  }

 private:
  template <class N>
  static N fade(const N& t) {
    return t * t * t * (t * (t * N(6) - N(15)) + N(10));
  }
  /// Returns the product of a corner's gradient with the vector from the corner.
  template <class N>
  N corner(std::int64_t i, std::int64_t j, std::int64_t k, const N& x, const N& y, const N& z) const {
    const unsigned hash = at(at(at(i) + j) + k) & 15;
    const N& a = hash < 8 ? x : y;
    const N& b = hash < 4 ? y : (hash == 12 || hash == 14) ? x : z;
    const N first = (hash & 1) != 0 ? N(0) - a : a;
    return (hash & 2) != 0 ? first - b : first + b;
  }
  std::int64_t at(std::int64_t i) const { return permutation_[static_cast<std::size_t>(i & 255)]; }

  std::array<std::uint8_t, 256> permutation_;
};

}  // namespace tubefoot
