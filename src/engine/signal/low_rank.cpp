// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/low_rank.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tubefoot {

std::vector<std::complex<double>> LowRankFactor::times(const std::vector<std::complex<double>>& z) const {
  std::vector<std::complex<double>> sum(size);
  for (std::size_t k = 0; k < rank; ++k)
    for (std::size_t row = 0; row < size; ++row) sum[row] += column[k * size + row] * z[k];
  return sum;
}

LowRankFactor low_rank_factor(CovarianceMatrix matrix, double tolerance) {
  constexpr double rounding = 1e-10;  // relative to the largest variance
  const std::size_t n = matrix.size;
  if (n == 0 || matrix.value.size() != n * n)
    throw std::invalid_argument(
        fmt::format("a covariance matrix needs {} values and at least one row, but has {} values", n * n,
                    matrix.value.size()));
  LowRankFactor factor;
  factor.size = n;
  std::vector<double> left(n);
  double trace = 0, largest = 0;
  for (std::size_t k = 0; k < n; ++k) {
    left[k] = matrix.at(k, k).real();
    trace += left[k];
    largest = std::max(largest, left[k]);
  }
  for (;;) {
    const auto pivot = std::size_t(std::max_element(left.begin(), left.end()) - left.begin());
    const double worst = *std::min_element(left.begin(), left.end());
    if (worst < -rounding * largest)
      throw std::invalid_argument(
          fmt::format("the covariance matrix is not positive semidefinite: the remainder of a variance is "
                      "{}, while the largest variance is {}",
                      worst, largest));
    double rest = 0;
    for (const double variance : left) rest += std::max(variance, 0.0);
    factor.rest = trace > 0 ? rest / trace : 0;
    if (!(factor.rest > tolerance) || factor.rank == n) return factor;
    const double root = std::sqrt(left[pivot]);
    const std::size_t begin = factor.column.size();
    factor.column.resize(begin + n);
    for (std::size_t row = 0; row < n; ++row) {
      std::complex<double> sum = matrix.at(row, pivot);
      for (std::size_t k = 0; k < factor.rank; ++k)
        sum -= factor.column[k * n + row] * std::conj(factor.column[k * n + pivot]);
      factor.column[begin + row] = sum / root;
    }
    factor.column[begin + pivot] = root;
    for (std::size_t row = 0; row < n; ++row) left[row] -= std::norm(factor.column[begin + row]);
    left[pivot] = 0;
    ++factor.rank;
  }
}

}  // namespace tubefoot
