// SPDX-License-Identifier: GPL-3.0-or-later
// Integrals of e^{i phase} over segments, triangles and polygons on which the phase is affine. Means over
// triangles are divided differences of exp, or a series where phases are close. Polygons use Gordon's sum
// over edges (doi 10.1109/TAP.1975.1141105), or a fan of triangles where that sum loses digits.

#include "geometry/integrals/polygon_transform.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

double sinc(double x) { return x == 0 ? 1 : std::sin(x) / x; }

std::complex<double> times_i(std::complex<double> z) { return {-z.imag(), z.real()}; }

}  // namespace

std::complex<double> phasor(double phase) { return {std::cos(phase), std::sin(phase)}; }

std::complex<double> mean_phasor(double a, double b) { return phasor((a + b) / 2) * sinc((b - a) / 2); }

std::complex<double> mean_phasor(double a, double b, double c) {
  // Above this limit the divided difference is as accurate as the series. Below it the series needs few
  // terms.
  constexpr double series_up_to = 1.5;
  const double middle = (a + b + c) / 3, x = a - middle, y = b - middle, z = -(x + y);
  const double largest = std::max({std::abs(x), std::abs(y), std::abs(z)});
  if (largest > series_up_to) {
    std::array<double, 3> phase{a, b, c};
    std::sort(phase.begin(), phase.end());
    const std::complex<double> change = mean_phasor(phase[1], phase[2]) - mean_phasor(phase[0], phase[1]);
    return times_i(change) * (-2 / (phase[2] - phase[0]));
  }
  // 2 sum of i^k h_k / (k + 2)!, where h_k are the complete homogeneous polynomials of x, y, z. The sum
  // x + y + z is 0, so the generating function of h_k is
  //   1 / ((1 - x u)(1 - y u)(1 - z u)) = 1 / (1 + e2 u^2 - e3 u^3).
  const double e2 = x * y + z * (x + y), e3 = x * y * z;
  double before2 = 0, before1 = 0, now = 1, weight = 1, bound = 1;
  double real = 1, imaginary = 0;
  for (int k = 1; bound > 1e-18; ++k) {
    const double next = -e2 * before1 + e3 * before2;
    before2 = before1;
    before1 = now;
    now = next;
    weight /= k + 2;
    bound *= largest / k;
    const double term = now * weight;
    switch (k % 4) {
      case 0:
        real += term;
        break;
      case 1:
        imaginary += term;
        break;
      case 2:
        real -= term;
        break;
      default:
        imaginary -= term;
    }
  }
  return phasor(middle) * std::complex<double>(real, imaginary);
}

std::complex<double> polygon_transform(std::span<const glm::dvec2> offsets, glm::dvec2 gradient) {
  const std::size_t n = offsets.size();
  if (n < 3) return 0;
  double perimeter = 0, twice_area = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const glm::dvec2 a = offsets[k], b = offsets[k + 1 == n ? 0 : k + 1];
    perimeter += glm::length(b - a);
    twice_area += cross(a, b);
  }
  std::complex<double> sum = 0;
  // The rounding error of an edge is one rounding of its length over |gradient|. Under this condition it is
  // no larger than that of the area.
  const double square = glm::dot(gradient, gradient);
  if (n > 3 && perimeter <= 2 * std::sqrt(square) * std::abs(twice_area)) {
    for (std::size_t k = 0; k < n; ++k) {
      const glm::dvec2 a = offsets[k], b = offsets[k + 1 == n ? 0 : k + 1], edge = b - a;
      sum += cross(gradient, edge) * mean_phasor(glm::dot(gradient, a), glm::dot(gradient, b));
    }
    return -times_i(sum) / square;
  }
  for (std::size_t k = 1; k + 1 < n; ++k)
    sum += cross(offsets[k], offsets[k + 1]) / 2 *
           mean_phasor(0, glm::dot(gradient, offsets[k]), glm::dot(gradient, offsets[k + 1]));
  return sum;
}

std::complex<double> polygon_transform(std::span<const glm::dvec3> corners, glm::dvec3 normal, glm::dvec3 q) {
  if (corners.size() < 3) return 0;
  const PlaneFrame frame({normal, 0});  // u x v = -normal
  std::vector<glm::dvec2> offsets;
  for (const glm::dvec3& corner : corners) {
    const glm::dvec2 offset = frame.project(corner - corners[0]);
    offsets.emplace_back(offset.y, offset.x);
  }
  const glm::dvec2 gradient = frame.project(q);
  return phasor(glm::dot(q, corners[0])) * polygon_transform(offsets, {gradient.y, gradient.x});
}

}  // namespace tubefoot
