// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/relief/fourier.hpp"

#include <fftw3.h>

#include <algorithm>
#include <mutex>
#include <new>

namespace tubefoot {
namespace {

using Complex = std::complex<long double>;
static_assert(sizeof(Complex) == sizeof(fftwl_complex));

constexpr unsigned kFlags = FFTW_ESTIMATE | FFTW_UNALIGNED;

fftwl_complex* fftw(Complex* z) { return reinterpret_cast<fftwl_complex*>(z); }
long double* reals(Complex* z) { return reinterpret_cast<long double*>(z); }

// Only one thread at a time may use FFTW's planner.
std::mutex& planner() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

void InverseTransforms::Destroy::operator()(fftwl_plan_s* plan) const {
  const std::scoped_lock lock(planner());
  fftwl_destroy_plan(plan);
}

InverseTransforms::InverseTransforms(std::size_t nodes) {
  const int n = static_cast<int>(nodes);
  std::vector<Complex> any(nodes + 2);
  {
    const std::scoped_lock lock(planner());
    column_.reset(fftwl_plan_dft_1d(n, fftw(any.data()), fftw(any.data()), FFTW_BACKWARD, kFlags));
    row_.reset(fftwl_plan_dft_c2r_1d(n, fftw(any.data()), reals(any.data()), kFlags));
  }
  if (!column_ || !row_) throw std::bad_alloc();
}

void InverseTransforms::column(Complex* z) const { fftwl_execute_dft(column_.get(), fftw(z), fftw(z)); }

void InverseTransforms::row(Complex* z) const { fftwl_execute_dft_c2r(row_.get(), fftw(z), reals(z)); }

std::vector<Complex> plane_waves(const std::vector<double>& heights, std::size_t columns, std::size_t rows) {
  const std::size_t half = columns / 2 + 1;
  std::vector<Complex> waves(half * rows);
  for (std::size_t j = 0; j < rows; ++j)
    std::copy_n(heights.begin() + static_cast<std::ptrdiff_t>(j * columns), columns,
                reals(waves.data() + j * half));
  std::unique_lock lock(planner());
  fftwl_plan plan = fftwl_plan_dft_r2c_2d(static_cast<int>(rows), static_cast<int>(columns),
                                          reals(waves.data()), fftw(waves.data()), kFlags);
  lock.unlock();
  if (plan == nullptr) throw std::bad_alloc();
  fftwl_execute(plan);
  lock.lock();
  fftwl_destroy_plan(plan);
  for (Complex& wave : waves) wave /= static_cast<long double>(heights.size());
  return waves;
}

}  // namespace tubefoot
