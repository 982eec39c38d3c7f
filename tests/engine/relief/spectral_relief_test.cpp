// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/relief/spectral_relief.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <random>
#include <stdexcept>
#include <vector>

#include "engine/relief/fourier.hpp"
#include "engine/relief/portable_random.hpp"
#include "geometry/numbers/scalars.hpp"

// Tests random relief from spectra: spectral exponent, structure function, isotropy, ripple direction, and
// identical bits on every machine. The formulas and tolerances are those of section 6 of the physics sheet.
namespace tubefoot {
namespace {

/// Heights at the nodes, row by row from the south-west.
std::vector<double> nodes_of(const SplineSurface& surface) {
  std::vector<double> heights;
  const SplineSurface::Lattice& lattice = surface.lattice();
  for (std::size_t j = 0; j < surface.rows(); ++j)
    for (std::size_t i = 0; i < surface.columns(); ++i)
      heights.push_back(
          surface.height_m({lattice.west_m + lattice.spacing_x_m * static_cast<double>(i),
                            lattice.south_m + lattice.spacing_y_m * static_cast<double>(j), 0}));
  return heights;
}

double mean_square(const std::vector<double>& heights) {
  return std::inner_product(heights.begin(), heights.end(), heights.begin(), 0.0) /
         static_cast<double>(heights.size());
}

/// |A|^2 at (kx, ky), -n / 2 <= k < n / 2, of an n x n map.
class Power {
 public:
  Power(const std::vector<double>& heights, int n) : n_(n), waves_(plane_waves(heights, n, n)) {}
  std::complex<double> amplitude(int kx, int ky) const {
    if (kx < 0) return std::conj(amplitude(-kx, -ky));
    const std::complex<long double> a = waves_[static_cast<std::size_t>((ky + n_) % n_ * (n_ / 2 + 1) + kx)];
    return {static_cast<double>(a.real()), static_cast<double>(a.imag())};
  }
  double operator()(int kx, int ky) const { return std::norm(amplitude(kx, ky)); }

 private:
  int n_;
  std::vector<std::complex<long double>> waves_;
};

/// Estimates the Hurst exponent from the slope of the mean |A|^2 of rings over wavenumbers 4 to n / 4, in
/// logarithms.
double hurst_of(const std::vector<double>& heights, int n) {
  const Power power(heights, n);
  std::vector<double> sum(n), count(n);
  for (int y = -n / 2 + 1; y < n / 2; ++y)
    for (int x = -n / 2 + 1; x < n / 2; ++x) {
      const auto ring = static_cast<std::size_t>(std::lround(std::hypot(x, y)));
      sum[ring] += power(x, y);
      count[ring] += 1;
    }
  double w = 0, u = 0, v = 0, uu = 0, uv = 0;
  for (int k = 4; k <= n / 4; ++k) {
    const double a = std::log(k), b = std::log(sum[k] / count[k]);
    w += 1, u += a, v += b, uu += a * a, uv += a * b;
  }
  return -(w * uv - u * v) / (w * uu - u * u) / 2 - 1;
}

struct StructureTensor {
  double coherence, direction_deg;  ///< compass direction across the crests, 0 to 180
};
/// Computes the structure tensor of a surface with nodes 1 m apart. Slopes use short steps, because steps
/// of whole nodes turn the directions of short waves.
StructureTensor structure_tensor(const SplineSurface& surface) {
  double xx = 0, xy = 0, yy = 0;
  constexpr double step = 0.01;
  for (std::size_t j = 0; j < surface.rows(); ++j)
    for (std::size_t i = 0; i < surface.columns(); ++i) {
      const glm::dvec3 p(i, j, 0), east(step, 0, 0), north(0, step, 0);
      const double x = surface.height_m(p + east) - surface.height_m(p - east),
                   y = surface.height_m(p + north) - surface.height_m(p - north);
      xx += x * x, xy += x * y, yy += y * y;
    }
  const double from_east = 0.5 * std::atan2(2 * xy, xx - yy) * 180 / pi;
  return {std::hypot(xx - yy, 2 * xy) / (xx + yy), std::fmod(90 - from_east + 180, 180)};
}

FractalRelief unit_cells(int n, double hurst, std::uint64_t seed) {
  return {{static_cast<double>(n), 1, seed}, hurst, 1.0};
}

TEST(FractalRelief, RadialSpectrumGivesBackTheHurstExponent) {
  constexpr int n = 256, seeds = 8;
  for (const double hurst : {0.2, 0.5, 0.625, 0.8}) {
    double mean = 0;
    for (int seed = 1; seed <= seeds; ++seed)
      mean += hurst_of(nodes_of(*make_surface(unit_cells(n, hurst, seed))), n) / seeds;
    EXPECT_NEAR(mean, hurst, 0.05) << "seeds 1 to " << seeds;
  }
}

/// Returns 2 sum of the ensemble's |A|^2 (1 - cos K r) over the wavenumbers of the tile, for the APL-UW
/// spectrum in centimetres.
double ensemble_structure(const FractalRelief& relief, double x_m, double y_m) {
  const int n = static_cast<int>(relief.nodes());
  const double step_per_cm = 2 * pi / (relief.tile_m * 100);
  double sum_cm2 = 0;
  for (int ky = -n / 2; ky <= n / 2; ++ky)
    for (int kx = -n / 2; kx <= n / 2; ++kx) {
      const double k = std::hypot(kx, ky);
      if (k == 0 || k >= n / 2.0) continue;
      const double spectrum_cm4 =
          relief.spectral_strength_cm4 * std::pow(k * step_per_cm, -(2 * relief.hurst + 2));
      const double phase = step_per_cm * 100 * (kx * x_m + ky * y_m);
      sum_cm2 += 2 * spectrum_cm4 * step_per_cm * step_per_cm * (1 - std::cos(phase));
    }
  return sum_cm2 * 1e-4;
}

TEST(FractalRelief, StructureFunctionIsTheEnsemblesInTheMeanOverSeeds) {
  constexpr int n = 128, seeds = 60;
  for (const double hurst : {0.3, 0.625}) {
    FractalRelief relief{{6.4, 0.05}, hurst, {}, 0.0027};
    ASSERT_EQ(relief.nodes(), n);
    const std::vector<std::array<int, 2>> lags{{1, 0}, {0, 1}, {2, 1}, {3, -3}, {0, 8}, {16, 0}};
    std::vector<double> mean(lags.size());
    for (int seed = 1; seed <= seeds; ++seed) {
      relief.seed = seed;
      const std::vector<double> h = nodes_of(*make_surface(relief));
      for (std::size_t l = 0; l < lags.size(); ++l)
        for (int j = 0; j < n; ++j)
          for (int i = 0; i < n; ++i) {
            const double d = h[(j + lags[l][1] + n) % n * n + (i + lags[l][0]) % n] - h[j * n + i];
            mean[l] += d * d / (n * n * seeds);
          }
    }
    for (std::size_t l = 0; l < lags.size(); ++l) {
      const double exact = ensemble_structure(relief, 0.05 * lags[l][0], 0.05 * lags[l][1]);
      EXPECT_NEAR(mean[l] / exact, 1, 0.06) << hurst << " lag " << lags[l][0] << ", " << lags[l][1];
    }
  }
}

TEST(FractalRelief, AplSpectraGiveTheStructureFunctionsOfTheirClosedForm) {
  // D(r) = C w2 r^(2 a), a = gamma2 / 2 - 1, in centimetres; C of section 3.3.
  const struct { double gamma2, c; } cases[] = {{2.75, 16.077660}, {3.0, 12.566371}, {3.25, 11.175175}};
  for (const auto& [gamma2, c] : cases) {
    constexpr int seeds = 12, n = 256, lag = 6;
    constexpr double w2 = 0.004446, node_cm = 4, r_cm = lag * node_cm;
    double mean_cm2 = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
      FractalRelief relief{{n * node_cm / 100, node_cm / 100}, gamma2 / 2 - 1, {}, w2};
      relief.seed = seed;
      const std::vector<double> h = nodes_of(*make_surface(relief));
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const double d = h[j * n + (i + lag) % n] - h[j * n + i];
          mean_cm2 += d * d * 1e4 / (n * n * seeds);
        }
    }
    // The tile lacks waves shorter than two nodes, for which the mean of 1 - cos is 1. It also lacks waves
    // longer than the circle in place of wavenumber 0, for which 1 - cos is (K r)^2 / 4.
    const double shortest = pi / node_cm, longest = 2 * std::sqrt(pi) / (n * node_cm);
    const double missing = 4 * pi * w2 * std::pow(shortest, 2 - gamma2) / (gamma2 - 2) +
                           pi * w2 * r_cm * r_cm * std::pow(longest, 4 - gamma2) / (4 - gamma2);
    EXPECT_NEAR((mean_cm2 + missing) / (c * w2 * std::pow(r_cm, gamma2 - 2)), 1, 0.04) << gamma2;
  }
}

TEST(FractalRelief, IsIsotropic) {
  double coherence = 0;
  constexpr int seeds = 8;
  for (int seed = 1; seed <= seeds; ++seed)
    coherence += structure_tensor(*make_surface(unit_cells(256, 0.8, seed))).coherence / seeds;
  EXPECT_LT(coherence, 0.05);
}

TEST(FractalRelief, NodesAreTheSumOfWavesThatTheFormulaSays) {
  FractalRelief relief{{8, 0.5, 42}, 0.7, {}, 0.01};
  const auto surface = make_surface(relief);
  ASSERT_EQ(surface->columns(), 16u);
  const long double step = 2 * std::numbers::pi_v<long double> / 8;
  for (int j = 0; j < 16; j += 3)
    for (int i = 0; i < 16; ++i) {
      long double height = 0;
      for (int ky = -7; ky <= 7; ++ky)
        for (int kx = -7; kx <= 7; ++kx) {
          const bool half = kx > 0 || (kx == 0 && ky > 0);
          const int square = kx * kx + ky * ky;
          if (!half || square >= 64) continue;
          const auto [re, im] = normal_pair(42, 1, kx, ky);
          const long double k = step * std::sqrt(static_cast<long double>(square));
          const long double size = step * std::sqrt(0.01e-8L / 2 * std::pow(k * 0.01L, -3.4L));
          const long double phase = step * (kx * i + ky * j) * 0.5L;
          height += 2 * size * (re * std::cos(phase) - im * std::sin(phase));
        }
      const double got = surface->height_m({0.5 * i, 0.5 * j, 0});
      EXPECT_NEAR(got, static_cast<double>(height), 2e-6 * surface->largest_m()) << i << " " << j;
    }
}

TEST(FractalRelief, HasTheRootMeanSquareItIsToldAndNoMean) {
  for (const double rms : {0.0, 0.35}) {
    const auto surface = make_surface(FractalRelief{{30, 0.2, 5}, 0.8, rms});
    const std::vector<double> heights = nodes_of(*surface);
    EXPECT_NEAR(std::sqrt(mean_square(heights)), rms, 1e-6 * rms);
    EXPECT_NEAR(surface->rms_height_m(), rms, 1e-6 * rms);
    EXPECT_NEAR(std::accumulate(heights.begin(), heights.end(), 0.0) / static_cast<double>(heights.size()), 0,
                1e-7 * rms);
  }
}

TEST(FractalRelief, FinerNodesAddDetailToTheSameSeabed) {
  FractalRelief coarse{{10, 10.0 / 64, 3}, 0.6, {}, 0.005}, fine = coarse;
  fine.resolution_m /= 2;
  const Power a(nodes_of(*make_surface(coarse)), 64), b(nodes_of(*make_surface(fine)), 128);
  for (int y = -31; y <= 31; ++y)
    for (int x = -31; x <= 31; ++x) {
      if (x * x + y * y < 32 * 32) {
        EXPECT_LT(std::abs(a.amplitude(x, y) - b.amplitude(x, y)), 1e-8) << x << " " << y;
      }
    }
  EXPECT_GT(b(33, 0), 0);
  EXPECT_LT(a(31, 31), 1e-20) << "beyond the Nyquist circle";
}

TEST(RippleRelief, PeakCentroidAndDirectionAreTheWantedOnes) {
  // The example of the physics sheet: 20 waves in one direction and 12 in the other on 256 nodes, H = 0.9.
  constexpr int n = 256;
  for (int seed = 1; seed <= 8; ++seed) {
    RippleRelief relief{{n, 1, static_cast<std::uint64_t>(seed)}, n / std::hypot(20, 12), 59.036, 0.9, 0.1};
    const auto surface = make_surface(relief);
    const std::vector<double> heights = nodes_of(*surface);
    EXPECT_NEAR(std::sqrt(mean_square(heights)), 0.1, 1e-6);
    const Power power(heights, n);
    double most = 0, east = 0, north = 0, all = 0;
    std::array<int, 2> peak{};
    for (int y = -n / 2 + 1; y < n / 2; ++y)
      for (int x = 1; x < n / 2; ++x) {
        const double p = power(x, y);
        if (p > most) most = p, peak = {x, y};
        east += p * x, north += p * y, all += p;
      }
    EXPECT_LE(std::abs(peak[0] - 20), 1) << seed;
    EXPECT_LE(std::abs(peak[1] - 12), 1) << seed;
    EXPECT_NEAR(east / all, 20, 1) << seed;
    EXPECT_NEAR(north / all, 12, 1) << seed;
    const StructureTensor tensor = structure_tensor(*surface);
    EXPECT_NEAR(tensor.direction_deg, 59.036, 1.5) << seed;
    EXPECT_GT(tensor.coherence, 0.9) << seed;
  }
}

TEST(RippleRelief, DirectionIsTheCompassDirectionAcrossTheCrests) {
  for (const double direction : {0.0, 30.0, 90.0, 135.0, 300.0}) {
    const RippleRelief relief{{256, 1, 9}, 8, direction, 0.95, 0.1};
    const StructureTensor tensor = structure_tensor(*make_surface(relief));
    EXPECT_NEAR(std::remainder(tensor.direction_deg - direction, 180), 0, 1.5) << direction;
  }
  EXPECT_EQ((RippleRelief{{100, 1}, 4, 90}.carrier()), (std::array<std::int64_t, 2>{25, 0}));
  EXPECT_EQ((RippleRelief{{100, 1}, 4, 180}.carrier()), (std::array<std::int64_t, 2>{0, -25}));
}

TEST(SpectralRelief, SurfacesOfOneSeedAreAlikeOnAnyNumberOfThreads) {
  const FractalRelief fractal{{20, 0.1, 11}, 0.7, 0.2};
  const RippleRelief ripples{{20, 0.1, 11}, 1, 20, 0.9, 0.02};
  const std::vector<double> a = nodes_of(*make_surface(fractal)), b = nodes_of(*make_surface(ripples));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(nodes_of(*make_surface(fractal)), a);
  EXPECT_EQ(nodes_of(*make_surface(ripples)), b);
  FractalRelief other = fractal;
  other.seed = 12;
  EXPECT_NE(nodes_of(*make_surface(other)), a);
}

TEST(SpectralRelief, APlaceHasOneHeightInAnyOrderOnAnyThread) {
  const auto surface = make_surface(FractalRelief{{20, 0.1, 11}, 0.7, 0.2});
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> at(-1000, 1000);
  std::vector<glm::dvec3> places(20000);
  for (glm::dvec3& p : places) p = {at(random), at(random), at(random)};
  std::vector<double> one_way, many(places.size());
  for (const glm::dvec3& p : places) one_way.push_back(surface->height_m(p));
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t n) {
    const std::size_t i = places.size() - 1 - n;
    many[i] = surface->height_m({places[i].x, places[i].y, 0});
  });
  EXPECT_EQ(one_way, many);
}

// These bits are not from the specification. They were computed once, and each machine and compiler must
// reproduce them.
TEST(SpectralRelief, HeightsAreTheSameOnEveryMachine) {
  const auto fractal = make_surface(FractalRelief{{20, 0.1, 2026}, 0.7, 0.2});
  const auto ripples = make_surface(RippleRelief{{20, 0.1, 2026}, 1, 20, 0.9, 0.02});
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const auto& surface : {fractal, ripples})
    for (int n = 0; n < 5000; ++n) {
      const double h = surface->height_m({0.37 * n - 500, 0.11 * n, 0});
      hash = (hash ^ std::bit_cast<std::uint64_t>(h)) * 0x100000001b3u;
    }
  EXPECT_EQ(hash, 0xe4d4d5547c9fd6a1u) << std::hex << hash;
}

TEST(SpectralRelief, RefusesWhatItCannotMake) {
  EXPECT_THROW(make_surface(FractalRelief{{1000, 0.01}, 0.8, 0.1}), std::invalid_argument);
  EXPECT_THROW(make_surface(FractalRelief{{1e7, 1e-9}, 0.8, 0.1}), std::invalid_argument);
  EXPECT_THROW(make_surface(RippleRelief{{20, 0.1}, 0.3, 0, 0.9, 0.1}), std::invalid_argument) << "3 nodes";
  EXPECT_THROW(make_surface(RippleRelief{{20, 0.1}, 6, 0, 0.9, 0.1}), std::invalid_argument) << "3 waves";
  EXPECT_EQ((ReliefTile{10, 0.1}.nodes()), 112u);
  EXPECT_EQ((ReliefTile{10, 20}.nodes()), 16u);
  EXPECT_EQ((ReliefTile{16384, 1}.nodes()), 16384u);
}

}  // namespace
}  // namespace tubefoot
