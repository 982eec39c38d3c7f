// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/relief/spectral_relief.hpp"

#include <fmt/core.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include "engine/relief/fourier.hpp"
#include "engine/relief/portable_random.hpp"
#include "geometry/steps/stop.hpp"

// Synthesises periodic surfaces: Gaussian amplitudes per wavenumber, an inverse Fourier transform in long
// double and B-spline coefficients in single precision. Columns are transformed in parallel; the result does
// not depend on the number of threads.

namespace tubefoot {
namespace {

using Complex = std::complex<long double>;

// Returns the ratio of B-spline coefficients to node heights in the Fourier domain, along one axis. The
// height of a node is (1, 4, 1)/6 of the spline's coefficients.
std::vector<double> sharpening(std::size_t nodes) {
  std::vector<double> factors(nodes / 2 + 1);
  for (std::size_t k = 0; k < factors.size(); ++k) {
    const long double angle =
        2 * std::numbers::pi_v<long double> * static_cast<long double>(k) / static_cast<long double>(nodes);
    factors[k] = static_cast<double>(3 / (2 + std::cos(angle)));
  }
  return factors;
}

// Computes a surface from the amplitudes of its wavenumbers: height = sum over all (kx, ky) of A exp(i K x).
// `amplitude` is called for half the plane, kx > 0 or kx = 0 with ky > 0, below the Nyquist circle. The other
// half is the conjugate.
template <class Amplitude>
std::shared_ptr<const SplineSurface> synthesise(const ReliefTile& tile, std::optional<double> rms_height_m,
                                                const Amplitude& amplitude) {
  const std::size_t nodes = tile.nodes(), half = nodes / 2;
  const auto nyquist = static_cast<std::int64_t>(half);
  const std::vector<double> sharpen = sharpening(nodes);
  const InverseTransforms transforms(nodes);
  std::vector<Complex> plane((half + 1) * nodes);  // row by row

  // Columns are processed in blocks, so that a row of the plane is written in whole cache lines.
  constexpr std::size_t block = 4;
  const std::size_t blocks = half / block + 1;
  std::vector<std::vector<double>> powers(half +
                                          1);  // |A|^2 of both halves of the plane, by column and |k| - kx
  const auto column_of = [&](std::size_t kx) {
    const auto x = static_cast<std::int64_t>(kx);
    powers[kx].resize(half + 1 - kx);
    std::vector<Complex> column(nodes);
    for (std::int64_t y = x == 0 ? 1 : 1 - nyquist; y < nyquist && x < nyquist; ++y) {
      const std::int64_t square = x * x + y * y;
      if (square >= nyquist * nyquist) continue;
      const std::complex<double> a = amplitude(x, y);
      powers[kx][static_cast<std::size_t>(std::sqrt(static_cast<double>(square)) + 0.5) - kx] +=
          2 * std::norm(a);
      const double sharp = sharpen[kx] * sharpen[static_cast<std::size_t>(std::abs(y))];
      const Complex wide(a.real() * sharp, a.imag() * sharp);
      column[static_cast<std::size_t>(y < 0 ? y + 2 * nyquist : y)] = wide;
      if (x == 0) column[static_cast<std::size_t>(2 * nyquist - y)] = std::conj(wide);
    }
    return column;
  };
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
    std::array<std::vector<Complex>, block> columns;
    const std::size_t first = b * block, count = std::min(block, half + 1 - std::min(half + 1, first));
    for (std::size_t c = 0; c < count; ++c) {
      stop_if_wanted();
      columns[c] = column_of(first + c);
      transforms.column(columns[c].data());
    }
    for (std::size_t y = 0; y < nodes; ++y)
      for (std::size_t c = 0; c < count; ++c) plane[y * (half + 1) + first + c] = columns[c][y];
  });

  RadialSpectrum spectrum{2 * std::numbers::pi / tile.tile_m, std::vector<double>(half + 1)};
  double variance = 0;
  for (std::size_t kx = 0; kx <= half; ++kx)
    for (std::size_t n = 0; n < powers[kx].size(); ++n) {
      spectrum.power_m2[kx + n] += powers[kx][n];
      variance += powers[kx][n];
    }
  const double scale = rms_height_m ? *rms_height_m / std::sqrt(variance) : 1;
  for (double& power : spectrum.power_m2) power *= scale * scale;

  SplineGrid grid(nodes, nodes);
  tbb::parallel_for(std::size_t{0}, nodes, [&](std::size_t y) {
    stop_if_wanted();
    Complex* const z = plane.data() + y * (half + 1);
    transforms.row(z);
    const auto* const heights = reinterpret_cast<const long double*>(z);
    float* const row = grid.row(static_cast<std::ptrdiff_t>(y));
    // Single precision hides differences in the last bits between versions of the transform.
    for (std::size_t x = 0; x < nodes; ++x) row[x] = static_cast<float>(heights[x] * scale);
  });
  plane = {};
  powers = {};
  const double spacing = tile.tile_m / static_cast<double>(nodes);
  return std::make_shared<SplineSurface>(SplineSurface::Lattice{0, 0, spacing, spacing, true},
                                         std::move(grid), spectrum);
}

void check(const ReliefTile& tile) {
  if (!(tile.tile_m > 0 && tile.resolution_m > 0 && tile.tile_m / tile.resolution_m <= kMostNodes)) {
    throw std::invalid_argument(
        fmt::format("a tile of {} m with a resolution of {} m has {:.6g} nodes on a side, but the limit is "
                    "{}: use a coarser resolution_m or a smaller tile_m",
                    tile.tile_m, tile.resolution_m, std::ceil(tile.tile_m / tile.resolution_m), kMostNodes));
  }
}

// (kx^2 + ky^2)^(-(hurst + 1) / 2)
double fractal_amplitude(double hurst, std::int64_t square) {
  return portable_exp(-0.5 * (hurst + 1) * portable_log(static_cast<double>(square)));
}

constexpr std::uint64_t kFractalStream = 1, kRippleStream = 2;

}  // namespace

std::size_t ReliefTile::nodes() const {
  const double wanted = std::ceil(tile_m / resolution_m * (1 - 1e-12));  // 10 m at 0.1 m are 100
  for (std::size_t scale = 4;; scale *= 2)
    for (std::size_t n = 4; n < 8; ++n)
      if (static_cast<double>(n * scale) >= wanted) return n * scale;
}

std::array<std::int64_t, 2> RippleRelief::carrier() const {
  // In single precision, sines are the same on every machine. The nearest lattice point is then the same too.
  const double waves = tile_m / wavelength_m, direction = direction_deg * std::numbers::pi / 180;
  const auto east = static_cast<float>(std::sin(direction)), north = static_cast<float>(std::cos(direction));
  return {std::llround(waves * static_cast<double>(east)), std::llround(waves * static_cast<double>(north))};
}

std::shared_ptr<const SplineSurface> make_surface(const FractalRelief& relief) {
  check(relief);
  double unit = 1;
  if (!relief.rms_height_m) {
    // The variance of a wavenumber is W dK^2, here W at one wave per tile. Each of the two parts of A has
    // half of it.
    const double step_rad_m = 2 * std::numbers::pi / relief.tile_m;
    const double exponent = 2 * relief.hurst + 2;
    const double strength_m4 = relief.spectral_strength_cm4 * 1e-8;
    unit =
        step_rad_m * std::sqrt(strength_m4 / 2 * portable_exp(-exponent * portable_log(step_rad_m * 0.01)));
  }
  return synthesise(relief, relief.rms_height_m, [&](std::int64_t x, std::int64_t y) {
    const auto [re, im] = normal_pair(relief.seed, kFractalStream, x, y);
    return unit * fractal_amplitude(relief.hurst, x * x + y * y) * std::complex(re, im);
  });
}

std::shared_ptr<const SplineSurface> make_surface(const RippleRelief& relief) {
  check(relief);
  if (!(relief.wavelength_m >= 4 * relief.resolution_m && relief.wavelength_m <= relief.tile_m / 4)) {
    throw std::invalid_argument(fmt::format(
        "ripples of {} m need a resolution_m of at most {:.6g} m and a tile_m of at least {:.6g} m",
        relief.wavelength_m, relief.wavelength_m / 4, 4 * relief.wavelength_m));
  }
  const auto [kx, ky] = relief.carrier();
  // Amplitude of the complex surface. A fractional Brownian surface has no limit at wavenumber 0, so the code
  // uses the value for 1 there.
  const auto complex_surface = [&](std::int64_t x, std::int64_t y) {
    const auto [re, im] = normal_pair(relief.seed, kRippleStream, x, y);
    return fractal_amplitude(relief.hurst, std::max<std::int64_t>(1, x * x + y * y)) * std::complex(re, im);
  };
  return synthesise(relief, relief.rms_height_m, [&, x0 = kx, y0 = ky](std::int64_t x, std::int64_t y) {
    return complex_surface(x - x0, y - y0) + std::conj(complex_surface(-x - x0, -y - y0));
  });
}

}  // namespace tubefoot
