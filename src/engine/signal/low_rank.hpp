// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace tubefoot {

/// A Hermitian matrix, row-major.
struct CovarianceMatrix {
  std::size_t size = 0;
  std::vector<std::complex<double>> value;

  std::complex<double>& at(std::size_t row, std::size_t column) { return value[row * size + column]; }
  std::complex<double> at(std::size_t row, std::size_t column) const { return value[row * size + column]; }
};

/// L of R = L L^H + rest, L with as few columns as leave a rest of small trace.
struct LowRankFactor {
  std::size_t size = 0, rank = 0;
  std::vector<std::complex<double>> column;  ///< [rank][size]
  double rest = 0;                           ///< trace of what is left out, over the trace

  /// L z.
  std::vector<std::complex<double>> times(const std::vector<std::complex<double>>& z) const;
};

/// Cholesky's factor with the largest pivot first, which stops where the rest's trace is below `tolerance`
/// times the trace (Harbrecht, Peters & Schneider, Appl. Numer. Math. 62, 2012). The rest is positive
/// semi-definite, so that no entry of it is larger than its trace.
/// Throws std::invalid_argument for a matrix that has a negative pivot larger than rounding: it is none of
/// covariances.
LowRankFactor low_rank_factor(CovarianceMatrix matrix, double tolerance = 1e-12);

}  // namespace tubefoot
