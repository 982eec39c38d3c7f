// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <vector>

struct fftwl_plan_s;

// Fourier transforms in long double, which FFTW computes without vector instructions. Every x86 machine
// therefore gives the same result. The result rounded to single precision does not depend on the last bits of
// an FFTW version. With FFTW_ESTIMATE the plan, and thus the rounding, depends on the length alone.
namespace tubefoot {

/// One-dimensional in-place transforms with positive sign, not normalised. Any number of threads may use one
/// object.
class InverseTransforms {
 public:
  explicit InverseTransforms(std::size_t nodes);

  void column(std::complex<long double>* z) const;
  /// Transforms half a Hermitian row (nodes / 2 + 1 numbers) to `nodes` real numbers.
  void row(std::complex<long double>* z) const;

 private:
  struct Destroy {
    void operator()(fftwl_plan_s* plan) const;
  };
  std::unique_ptr<fftwl_plan_s, Destroy> column_, row_;
};

/// Returns the amplitudes A of the plane waves of heights on a periodic lattice, height = sum of A exp(i (kx
/// x + ky y)). There are columns / 2 + 1 values of kx for each ky in 0 .. rows - 1.
std::vector<std::complex<long double>> plane_waves(const std::vector<double>& heights, std::size_t columns,
                                                   std::size_t rows);

}  // namespace tubefoot
