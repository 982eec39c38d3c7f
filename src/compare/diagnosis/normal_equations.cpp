// SPDX-License-Identifier: GPL-3.0-or-later
// Gauss-Jordan elimination.
#include "compare/diagnosis/normal_equations.hpp"

#include <cmath>

namespace tubefoot {

std::vector<double> inverted(std::vector<double> a, std::size_t n) {
  std::vector<double> scale(n), result(n * n);
  for (std::size_t i = 0; i < n; ++i) scale[i] = 1 / std::sqrt(a[i * n + i]);
  for (std::size_t i = 0; i < n; ++i) {
    result[i * n + i] = 1;
    for (std::size_t j = 0; j < n; ++j) a[i * n + j] *= scale[i] * scale[j];
    a[i * n + i] += 1e-6;  // regularisation: terms with nearly the same effect share it
  }
  for (std::size_t c = 0; c < n; ++c) {
    const double pivot = 1 / a[c * n + c];
    for (std::size_t j = 0; j < n; ++j) {
      a[c * n + j] *= pivot;
      result[c * n + j] *= pivot;
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (i == c) continue;
      const double factor = a[i * n + c];
      for (std::size_t j = 0; j < n; ++j) {
        a[i * n + j] -= factor * a[c * n + j];
        result[i * n + j] -= factor * result[c * n + j];
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) result[i * n + j] *= scale[i] * scale[j];
  return result;
}

}  // namespace tubefoot
