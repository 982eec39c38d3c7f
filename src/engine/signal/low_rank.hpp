// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace tubefoot {

/// Hermitian matrix, row-major.
struct CovarianceMatrix {
  std::size_t size = 0;
  std::vector<std::complex<double>> value;

  std::complex<double>& at(std::size_t row, std::size_t column) { return value[row * size + column]; }
  std::complex<double> at(std::size_t row, std::size_t column) const { return value[row * size + column]; }
};

/// Factor L of R = L L^H + rest, with the fewest columns for which the trace of the rest is small.
struct LowRankFactor {
  std::size_t size = 0, rank = 0;
  std::vector<std::complex<double>> column;  ///< [rank][size]
  double rest = 0;                           ///< trace of the rest, relative to the trace

  /// Product L z.
  std::vector<std::complex<double>> times(const std::vector<std::complex<double>>& z) const;
};

/// Cholesky factor with the largest pivot first. The factorisation stops when the trace of the rest is below
/// `tolerance` times the trace (Harbrecht, Peters & Schneider, Appl. Numer. Math. 62, 2012). The rest is
/// positive semi-definite, so no entry of the rest exceeds its trace. Throws std::invalid_argument for a
/// negative pivot beyond rounding, because such a matrix is not a covariance matrix.
LowRankFactor low_rank_factor(CovarianceMatrix matrix, double tolerance = 1e-12);

}  // namespace tubefoot
