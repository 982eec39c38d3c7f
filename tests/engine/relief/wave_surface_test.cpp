// SPDX-License-Identifier: GPL-3.0-or-later
// Tests wave spectra against closed forms and published wave heights. Tests their realisations against the
// integrals of the spectrum and the dispersion of waves on deep water.
#include "engine/relief/wave_surface.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/math/special_functions/expint.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "engine/relief/wave_spectrum.hpp"

namespace tubefoot {
namespace {

constexpr double g = standard_gravity_m_s2, endless = std::numeric_limits<double>::infinity();

/// Integral of density(w) w^power by the trapezoidal rule in log w.
double moment_by_trapezoids(const WaveSpectrum& spectrum, double lo, double hi, int power) {
  constexpr int steps = 20000;
  const double step = std::log(hi / lo) / steps;
  double sum = 0;
  for (int k = 0; k <= steps; ++k) {
    const double w = lo * std::exp(k * step);
    sum += (k % steps == 0 ? 0.5 : 1) * spectrum.density(w) * std::pow(w, power + 1) * step;
  }
  return sum;
}

std::vector<double> lattice_places(double first_m, double step_m, std::size_t count) {
  std::vector<double> places;
  for (std::size_t k = 0; k < count; ++k) places.push_back(first_m + step_m * static_cast<double>(k));
  return places;
}

double mean_of_squares(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return sum / static_cast<double>(values.size());
}

// m0 = alpha U^4 / (4 beta g^2). The peak is at (4 beta / 5)^(1/4) g / U.
TEST(WaveSpectrum, HasTheWaveHeightOfPiersonAndMoskowitz) {
  for (const double wind : {2.0, 7.5, 20.0}) {
    const WaveSpectrum spectrum = WaveSpectrum::pierson_moskowitz(wind);
    const double u = 1.026 * wind;
    EXPECT_NEAR(spectrum.significant_height_m() / (2 * u * u / g * std::sqrt(0.0081 / 0.74)), 1, 1e-12);
    EXPECT_NEAR(spectrum.peak_rad_s() * u / g, 0.8772, 5e-5);
  }
  // "H = 0.21 U^2 / g" for the wind at 19.5 m.
  EXPECT_NEAR(WaveSpectrum::pierson_moskowitz(10 / 1.026).significant_height_m() * g / 100, 0.21, 0.001);
}

// Goda (Random Seas and Design of Maritime Structures, 1985) approximates the same spectrum by its height H.
// There, the constant b = alpha g^2 / (wp^4 H^2) depends on the peak alone.
TEST(WaveSpectrum, GrowsWithTheFetchAsJonswap) {
  const double wind = 12, peak = 3.3, b = 0.0624 / (0.230 + 0.0336 * peak - 0.185 / (1.9 + peak));
  for (const double fetch_m : {2e4, 1e5}) {
    const double alpha = 0.076 * std::pow(g * fetch_m / (wind * wind), -0.22),
                 wp = 22 * std::pow(g * g / (wind * fetch_m), 1.0 / 3);
    const WaveSpectrum spectrum = WaveSpectrum::jonswap(wind, fetch_m);
    EXPECT_NEAR(spectrum.peak_rad_s(), wp, 1e-12);
    EXPECT_NEAR(spectrum.significant_height_m() / (g / (wp * wp) * std::sqrt(alpha / b)), 1, 0.01);
  }
}

TEST(WaveSpectrum, IntegratesItsDensity) {
  for (const WaveSpectrum& spectrum : {WaveSpectrum::pierson_moskowitz(9), WaveSpectrum::jonswap(9, 50000),
                                       WaveSpectrum::jonswap(25, 500)}) {
    const double peak = spectrum.peak_rad_s();
    const auto check = [&](double lo, double hi) {
      EXPECT_NEAR(spectrum.variance_m2(lo, hi) / moment_by_trapezoids(spectrum, lo, hi, 0), 1, 1e-7);
      EXPECT_NEAR(spectrum.slope_variance(lo, hi) / (moment_by_trapezoids(spectrum, lo, hi, 4) / (g * g)), 1,
                  1e-7);
    };
    check(0.3 * peak, 0.95 * peak);
    check(0.9 * peak, 1.3 * peak);
    check(0.5 * peak, 8 * peak);
    check(4 * peak, 9 * peak);
    EXPECT_NEAR(spectrum.variance_m2(0, endless),
                spectrum.variance_m2(0, 2 * peak) + spectrum.variance_m2(2 * peak, endless),
                1e-9 * spectrum.variance_m2(0, endless));
  }
}

// The slope variance up to w is alpha / 4 E1(5/4 (wp / w)^4).
TEST(WaveSpectrum, HasTheSlopesOfPiersonAndMoskowitz) {
  const WaveSpectrum spectrum = WaveSpectrum::pierson_moskowitz(10);
  for (const double times : {2.0, 6.0, 20.0})
    EXPECT_NEAR(spectrum.slope_variance(0, times * spectrum.peak_rad_s()),
                0.0081 / 4 * boost::math::expint(1, 1.25 / std::pow(times, 4)), 1e-10);
}

TEST(WaveSpectrum, RefusesAWindOrAFetchThatIsNotAbove0) {
  EXPECT_THROW(WaveSpectrum::pierson_moskowitz(0), std::invalid_argument);
  EXPECT_THROW(WaveSpectrum::jonswap(-1, 100), std::invalid_argument);
  EXPECT_THROW(WaveSpectrum::jonswap(5, 0), std::invalid_argument);
}

TEST(WaveSurface, HasTheVarianceAndTheSlopesOfItsSpectrum) {
  for (const WaveSpectrum& spectrum : {WaveSpectrum::pierson_moskowitz(6), WaveSpectrum::jonswap(12, 20000)})
    for (const std::uint64_t seed : {1u, 2u}) {
      const WaveSurface surface(spectrum, {40, 6}, 1, seed);
      const double end = deep_water_frequency(1);
      EXPECT_NEAR(surface.variance_m2() / spectrum.variance_m2(0.5 * spectrum.peak_rad_s(), end), 1, 1e-5);
      EXPECT_NEAR(surface.variance_m2() / spectrum.variance_m2(0, end), 1, 1e-5);
      EXPECT_NEAR(surface.slope_variance() / spectrum.slope_variance(0, end), 1, 0.01) << "seed " << seed;
    }
}

// The sample has about 1000 independent waves.
TEST(WaveSurface, HasHeightsWithTheVarianceOfItsSpectrum) {
  const WaveSpectrum spectrum = WaveSpectrum::pierson_moskowitz(4);
  const double finest_m = 0.25;
  const WaveSurface surface(spectrum, {200, 10}, 4 * finest_m, 3);
  const std::vector<double> east = lattice_places(-50, finest_m, 400),
                            north = lattice_places(20, finest_m, 400);
  const WaveLattice lattice(surface, east, north);
  double variance = 0, slopes = 0;
  constexpr int times = 4;
  for (int k = 0; k < times; ++k) {
    const std::vector<double> heights = lattice.heights_m(100 * k);
    variance += mean_of_squares(heights) / times;
    double sum = 0;
    for (std::size_t row = 0; row + 1 < north.size(); ++row)
      for (std::size_t column = 0; column + 1 < east.size(); ++column) {
        const double here = heights[row * east.size() + column],
                     dx = heights[row * east.size() + column + 1] - here,
                     dy = heights[(row + 1) * east.size() + column] - here;
        sum += (dx * dx + dy * dy) / (finest_m * finest_m);
      }
    slopes += sum / static_cast<double>((north.size() - 1) * (east.size() - 1)) / times;
  }
  EXPECT_NEAR(variance / surface.variance_m2(), 1, 0.06);
  // Differences over a quarter of the shortest wave weaken its slope by a tenth.
  EXPECT_NEAR(slopes / surface.slope_variance(), 0.96, 0.05);
  EXPECT_NEAR(4 * std::sqrt(variance), spectrum.significant_height_m(),
              0.05 * spectrum.significant_height_m());
}

// cos(k x - w t) is the wave at t = 0, displaced by t w / k. On deep water w / k = g / w.
TEST(WaveSurface, TravelsAtThePhaseSpeedOfDeepWater) {
  const double wavelength_m = 7, w = deep_water_frequency(wavelength_m),
               k = 2 * std::numbers::pi / wavelength_m, direction = 0.7,
               speed = std::sqrt(g * wavelength_m / (2 * std::numbers::pi)), time_s = 3.3;
  EXPECT_NEAR(deep_water_wavenumber(w), k, 1e-12);
  const WaveSurface surface(
      {{0.4, w, k * std::sin(direction), k * std::cos(direction), std::cos(0.9), std::sin(0.9)}});
  const std::vector<double> east = lattice_places(-3, 0.4, 20), north = lattice_places(1, 0.3, 15);
  std::vector<double> east_before, north_before;
  for (const double e : east) east_before.push_back(e - speed * time_s * std::sin(direction));
  for (const double n : north) north_before.push_back(n - speed * time_s * std::cos(direction));
  EXPECT_THAT(WaveLattice(surface, east, north).heights_m(time_s),
              testing::Pointwise(testing::DoubleNear(1e-12),
                                 WaveLattice(surface, east_before, north_before).heights_m(0)));
}

// The lattice against the sum of its definition.
TEST(WaveSurface, IsTheSumOfItsComponents) {
  const WaveSurface surface(WaveSpectrum::jonswap(8, 3000), {120, 4}, 0.8, 11);
  const std::vector<double> east = lattice_places(-7, 0.9, 12), north = lattice_places(3, 0.7, 9);
  const WaveLattice lattice(surface, east, north);
  for (const double time_s : {0.0, 12.75, 1.7e9}) {
    const std::vector<double> heights = lattice.heights_m(time_s);
    for (std::size_t row = 0; row < north.size(); ++row)
      for (std::size_t column = 0; column < east.size(); ++column) {
        double sum = 0;
        for (const WaveSurface::Component& c : surface.components())
          sum += c.amplitude_m * std::cos(c.east_rad_m * east[column] + c.north_rad_m * north[row] -
                                          c.frequency_rad_s * time_s + std::atan2(c.sine, c.cosine));
        EXPECT_NEAR(heights[row * east.size() + column], sum, time_s > 1e9 ? 1e-5 : 1e-11);
      }
  }
}

// Components of all frequencies obey w^2 = g k. Their energy travels downwind and spreads symmetrically:
// the mean of cos(angle) over cos^2s(angle / 2) is s / (s + 1).
TEST(WaveSurface, SpreadsAboutTheDirectionOfTheWind) {
  for (const double exponent : {0.0, 2.0, 10.0}) {
    const double towards = 0.6;
    const WaveSurface surface(WaveSpectrum::pierson_moskowitz(7),
                              {towards * 180 / std::numbers::pi, exponent}, 0.5, 5);
    double along = 0, across = 0, all = 0;
    for (const WaveSurface::Component& c : surface.components()) {
      const double k = std::hypot(c.east_rad_m, c.north_rad_m), energy = c.amplitude_m * c.amplitude_m;
      EXPECT_NEAR(k * g / (c.frequency_rad_s * c.frequency_rad_s), 1, 1e-12);
      EXPECT_NEAR(std::hypot(c.cosine, c.sine), 1, 1e-12);
      along += energy * (c.east_rad_m * std::sin(towards) + c.north_rad_m * std::cos(towards)) / k;
      across += energy * (c.east_rad_m * std::cos(towards) - c.north_rad_m * std::sin(towards)) / k;
      all += energy;
    }
    EXPECT_NEAR(along / all, exponent / (exponent + 1), 0.02) << exponent;
    EXPECT_NEAR(across / all, 0, 0.02) << exponent;
  }
}

TEST(WaveSurface, KeepsItsLongWavesWithAFinerCell) {
  const WaveSpectrum spectrum = WaveSpectrum::pierson_moskowitz(8);
  const WaveSurface coarse(spectrum, {0, 10}, 4, 9), fine(spectrum, {0, 10}, 1, 9),
      other(spectrum, {0, 10}, 4, 10);
  ASSERT_LT(coarse.components().size(), fine.components().size());
  const std::size_t whole_bands = coarse.components().size() - 24;  // the last band ends at the shortest wave
  for (std::size_t k = 0; k < whole_bands; ++k) {
    EXPECT_EQ(coarse.components()[k].amplitude_m, fine.components()[k].amplitude_m);
    EXPECT_EQ(coarse.components()[k].cosine, fine.components()[k].cosine);
    EXPECT_EQ(coarse.components()[k].east_rad_m, fine.components()[k].east_rad_m);
  }
  EXPECT_NE(coarse.components()[0].cosine, other.components()[0].cosine);
}

TEST(WaveSurface, IsGaussianAndContinuousInTime) {
  const WaveSurface surface(WaveSpectrum::pierson_moskowitz(3), {0, 10}, 0.4, 21);
  const std::vector<double> east = lattice_places(0, 0.5, 150), north = lattice_places(0, 0.5, 150);
  const WaveLattice lattice(surface, east, north);
  const std::vector<double> before = lattice.heights_m(5), after = lattice.heights_m(5.001);
  double fourth = 0, largest = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    fourth += std::pow(before[k], 4) / static_cast<double>(before.size());
    largest = std::max(largest, std::abs(after[k] - before[k]));
  }
  EXPECT_NEAR(fourth / std::pow(mean_of_squares(before), 2), 3, 0.3);
  EXPECT_LT(largest, 0.001 * 1.0);  // slower than 1 m/s
  EXPECT_GT(largest, 0);
  for (const double h : before) EXPECT_LE(std::abs(h), surface.bound_m());
}

}  // namespace
}  // namespace tubefoot
