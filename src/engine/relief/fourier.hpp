// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <vector>

struct fftwl_plan_s;

// Fourier transforms in long double, which FFTW computes without vector instructions: every x86 machine gives
// the same, and single precision of it is safe from another version's last bits. FFTW_ESTIMATE: the plan, and
// with it the rounding, depends on the length alone.
namespace tubefoot {

/// One-dimensional transforms in place with the sign +, not normalised, for any number of threads.
class InverseTransforms {
 public:
  explicit InverseTransforms(std::size_t nodes);

  void column(std::complex<long double>* z) const;
  /// Half a Hermitian row (nodes / 2 + 1 numbers) to as many reals as nodes.
  void row(std::complex<long double>* z) const;

 private:
  struct Destroy {
    void operator()(fftwl_plan_s* plan) const;
  };
  std::unique_ptr<fftwl_plan_s, Destroy> column_, row_;
};

/// Amplitudes of the plane waves of heights on a periodic lattice, height = sum of A exp(i (kx x + ky y)):
/// columns / 2 + 1 values of kx for each ky in 0 .. rows - 1.
std::vector<std::complex<long double>> plane_waves(const std::vector<double>& heights, std::size_t columns,
                                                   std::size_t rows);

}  // namespace tubefoot
