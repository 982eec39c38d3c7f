// SPDX-License-Identifier: GPL-3.0-or-later
// Tests phase noise of interferometers: its variance, density and distribution against integrals and
// against draws of correlated Gaussian numbers.

#include "sensors/receiver/phase_noise.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <complex>
#include <random>

#include "fixtures/statistics.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

constexpr double coherences[] = {0, 0.01, 0.3, 0.5, 0.7, 0.7071, 0.7072, 0.9, 0.99, 0.9999, 0.999999};

/// Integral over 0 to `end`, with more nodes where the density is narrow.
template <typename Integrand>
double integral(Integrand integrand, double g, double end) {
  const double width = std::min(end, std::sqrt(1 - g * g));
  double sum = 0, from = 0;
  for (double to = width; from < end; from = to, to = std::min(end, 2 * to))
    sum += boost::math::quadrature::gauss_kronrod<double, 61>::integrate(integrand, from, to, 5, 1e-14);
  return sum;
}

/// Phases of averaged products of two unit complex Gaussian numbers with coherence g.
std::vector<double> measured_phases(double g, int looks, int n, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto gaussian = [&] { return std::complex<double>(normal(random), normal(random)); };
  std::vector<double> phases;
  for (int i = 0; i < n; ++i) {
    std::complex<double> product = 0;
    for (int look = 0; look < looks; ++look) {
      const auto first = gaussian(), own = gaussian();
      product += first * std::conj(g * first + std::sqrt(1 - g * g) * own);
    }
    phases.push_back(std::arg(product));
  }
  return phases;
}

double mean_square(const std::vector<double>& phases) {
  double sum = 0;
  for (const double phase : phases) sum += phase * phase;
  return sum / static_cast<double>(phases.size());
}

/// Standard deviation of the mean square of n phases, by the fourth moment of the law.
double mean_square_sigma(double g, int n) {
  const double fourth =
      2 * integral([g](double phase) { return std::pow(phase, 4) * phase_density(phase, g); }, g, pi);
  return std::sqrt((fourth - std::pow(phase_variance(g), 2)) / n);
}

TEST(PhaseNoise, VarianceAtItsCheckValues) {
  EXPECT_NEAR(phase_variance(0), pi * pi / 3, 1e-14);
  EXPECT_NEAR(phase_variance(0.5), 1.785263, 5e-7);
  EXPECT_NEAR(phase_variance(0.9), 0.478341, 5e-7);
  EXPECT_NEAR(phase_variance(0.99), 0.069401, 5e-7);
  EXPECT_NEAR(std::sqrt(phase_variance(0.5)) * 180 / pi, 76.555, 5e-4);
  EXPECT_NEAR(std::sqrt(phase_variance(0.9)) * 180 / pi, 39.627, 5e-4);
  EXPECT_NEAR(std::sqrt(phase_variance(0.99)) * 180 / pi, 15.094, 5e-4);
  EXPECT_EQ(phase_variance(1), 0);
  // At g^2 = 1/2 the formula switches; there Li2(1/2) = pi^2/12 - log^2(2)/2.
  EXPECT_NEAR(phase_variance(std::sqrt(0.5)),
              pi * pi / 3 - pi * pi / 4 + pi * pi / 16 - (pi * pi / 12 - std::pow(std::log(2), 2) / 2) / 2,
              1e-14);
}

TEST(PhaseNoise, VarianceIsTheDensitysOwn) {
  for (const double g : coherences) {
    const double variance =
        2 * integral([g](double phase) { return phase * phase * phase_density(phase, g); }, g, pi);
    EXPECT_NEAR(phase_variance(g) / variance, 1, 1e-9) << g;
  }
}

TEST(PhaseNoise, DistributionIsTheDensitysIntegral) {
  for (const double g : coherences) {
    SCOPED_TRACE(testing::Message() << "coherence " << g);
    EXPECT_NEAR(phase_distribution(-pi, g), 0, 1e-14);
    EXPECT_NEAR(phase_distribution(pi, g), 1, 1e-14);
    EXPECT_EQ(phase_distribution(0, g), 0.5);
    for (const double phase : {1e-4, 0.01, 0.5, 2.0, 3.0}) {
      const double area = integral([g](double at) { return phase_density(at, g); }, g, phase);
      EXPECT_NEAR(phase_distribution(phase, g) - 0.5, area, 1e-10);
      EXPECT_NEAR(phase_distribution(-phase, g) - 0.5, -area, 1e-10);
    }
  }
  EXPECT_NEAR(phase_density(1, 0), 1 / (2 * pi), 1e-15);
  EXPECT_EQ(phase_distribution(-1e-9, 1), 0);
  EXPECT_EQ(phase_distribution(1e-9, 1), 1);
}

TEST(PhaseNoise, CorrelatedGaussiansObeyTheLaw) {
  const std::uint64_t seed = 20261121;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  const int n = 200000;
  for (const double g : {0.0, 0.5, 0.9, 0.99}) {
    SCOPED_TRACE(testing::Message() << "coherence " << g);
    const auto phases = measured_phases(g, 1, n, random);
    EXPECT_LT(statistics::kolmogorov_distance(phases, [g](double at) { return phase_distribution(at, g); }),
              statistics::kolmogorov_limit(n));
    EXPECT_NEAR(mean_square(phases), phase_variance(g), 6 * mean_square_sigma(g, n));
  }
}

TEST(PhaseNoise, DrawnErrorsObeyTheLaw) {
  const std::uint64_t seed = 20261121;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const std::uint32_t n = 50000;
  for (const double g : {0.0, 0.5, 0.9, 0.99, 0.999999}) {
    SCOPED_TRACE(testing::Message() << "coherence " << g);
    std::vector<double> phases;
    for (std::uint32_t i = 0; i < n; ++i)
      phases.push_back(draw_phase_error(SampleRandom(seed, 0, i / 1000, i % 1000), g));
    EXPECT_LT(statistics::kolmogorov_distance(phases, [g](double at) { return phase_distribution(at, g); }),
              statistics::kolmogorov_limit(n));
    if (g > 0.99) continue;  // there a few of 50 000 phases determine the mean square
    EXPECT_NEAR(mean_square(phases), phase_variance(g), 6 * mean_square_sigma(g, n));
  }
}

TEST(PhaseNoise, ADrawIsTheQuantileOfItsUniformNumber) {
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const SampleRandom random(5, 1, 2, i);
    const double g = coherences[i % std::size(coherences)], phase = draw_phase_error(random, g);
    EXPECT_NEAR(phase_distribution(phase, g), random.uniform_pair(Purpose::phase)[0], 1e-13);
    EXPECT_LE(std::abs(phase), pi);
    EXPECT_EQ(draw_phase_error(random, g), phase);
    EXPECT_EQ(draw_phase_error(random, 1), 0);
    EXPECT_LT(std::abs(draw_phase_error(random, std::nextafter(1, 0))), 1e-4);
  }
}

TEST(PhaseNoise, ManyLooksApproachTheirApproximation) {
  const std::uint64_t seed = 20261121;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  EXPECT_DOUBLE_EQ(phase_variance(0.8, 50), 0.36 / (100 * 0.64));
  for (const double g : {0.7, 0.9}) {
    const double variance = mean_square(measured_phases(g, 50, 4000, random));
    EXPECT_NEAR(variance / phase_variance(g, 50), 1, 0.15);  // 6 sigma of the estimate: 0.13
  }
  for (const double g : coherences)
    for (const int looks : {1, 2, 5, 100}) EXPECT_LE(phase_variance(g, looks), phase_variance(g));
}

TEST(PhaseNoise, RefusesWhatIsNoCoherence) {
  for (const double g : {-1e-9, 1 + 1e-9, std::nan("")}) {
    EXPECT_THROW(phase_density(0, g), std::invalid_argument);
    EXPECT_THROW(phase_distribution(0, g), std::invalid_argument);
    EXPECT_THROW(phase_variance(g), std::invalid_argument);
    EXPECT_THROW(draw_phase_error(SampleRandom(1, 2, 3, 4), g), std::invalid_argument);
  }
  EXPECT_THROW(phase_density(0, 1), std::invalid_argument);
  EXPECT_THROW(phase_variance(0.5, 0), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
