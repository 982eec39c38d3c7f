// SPDX-License-Identifier: GPL-3.0-or-later
// Tests speckle models: exponential, gamma and K distributions, textures, noise, and reproducible first
// values.

#include "sensors/receiver/speckle.hpp"

#include <gtest/gtest.h>

#include <array>
#include <boost/math/distributions/gamma.hpp>
#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <numbers>

#include "fixtures/statistics.hpp"

namespace tubefoot {
namespace {

constexpr std::uint64_t seed = 20261121;

/// Received energies of `n` range bins.
std::vector<double> draw(const Speckle& speckle, double mean_j, double noise_j, std::uint32_t n) {
  std::vector<double> energies;
  for (std::uint32_t i = 0; i < n; ++i)
    energies.push_back(
        received_energy(SampleRandom(seed, i / 100000, i / 1000 % 100, i % 1000), speckle, mean_j, noise_j));
  return energies;
}

/// Compares the distance to the distribution, and counts beyond some of its quantiles by exact binomial
/// tails.
template <typename Distribution>
void expect_model(const std::vector<double>& energies, Distribution distribution) {
  EXPECT_LT(statistics::kolmogorov_distance(energies, distribution),
            statistics::kolmogorov_limit(energies.size()));
  for (const double threshold : {0.01, 0.1, 1.0, 3.0, 6.0, 9.0}) {
    std::size_t below = 0;
    for (const double energy : energies) below += energy <= threshold ? 1 : 0;
    EXPECT_GT(statistics::tail_probability(below, energies.size(), distribution(threshold)),
              statistics::false_alarm)
        << below << " below " << threshold;
  }
}

/// Single look of the K distribution: P(I <= x) = 1 - 2 / Gamma(nu) (nu x)^(nu/2) K_nu(2 sqrt(nu x)), unit
/// mean.
double k_distribution(double nu, double x) {
  const double z = nu * x;
  return 1 - 2 / std::tgamma(nu) * std::pow(z, nu / 2) * boost::math::cyl_bessel_k(nu, 2 * std::sqrt(z));
}

TEST(Speckle, OffReturnsTheVeryBits) {
  for (const double energy : {0.0, 5e-324, 1e-300, 0.1, 1 / 3.0, 1.7e308})
    EXPECT_EQ(received_energy(SampleRandom(1, 2, 3, 4), {}, energy, 0), energy);
  EXPECT_EQ(received_energy(SampleRandom(1, 2, 3, 4), {SpeckleModel::k, 0.5, 1}, 0, 0), 0);
}

TEST(Speckle, RayleighIsTheExponentialLaw) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const auto energies = draw({SpeckleModel::rayleigh, 1, 1}, 1, 0, 400000);
  expect_model(energies, [](double x) { return -std::expm1(-x); });
  const double sigma = 1 / std::sqrt(400000.0);  // of the mean; the other limits are 6 sigma as well
  EXPECT_NEAR(statistics::mean(energies), 1, 6 * sigma);
  EXPECT_NEAR(statistics::scintillation(energies), 2, 6 * 2 * sigma);  // variance of the estimate: 4/n

  std::vector<double> amplitudes, levels;
  for (const double energy : energies) {
    amplitudes.push_back(std::sqrt(energy));
    levels.push_back(10 * std::log10(energy));
  }
  EXPECT_NEAR(statistics::mean(amplitudes), 0.886227, 6 * 0.463 * sigma);
  EXPECT_NEAR(std::sqrt(statistics::variance(amplitudes)) / statistics::mean(amplitudes), 0.522723, 0.003);
  EXPECT_NEAR(statistics::mean(levels), -2.506816, 6 * 5.57 * sigma);
  EXPECT_NEAR(std::sqrt(statistics::variance(levels)), 5.570043, 0.06);
}

TEST(Speckle, LooksMakeTheGammaLaw) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  for (const int looks : {2, 3, 4, 9}) {
    SCOPED_TRACE(testing::Message() << looks << " looks");
    const auto energies = draw({SpeckleModel::rayleigh, 1, looks}, 1, 0, 200000);
    const boost::math::gamma_distribution<> model(looks, 1.0 / looks);
    expect_model(energies, [&](double x) { return cdf(model, x); });
    EXPECT_NEAR(std::sqrt(statistics::variance(energies)), 1 / std::sqrt(looks), 0.02);
  }
}

TEST(Speckle, KLawOverFourShapes) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const struct {
    double shape, amplitude;  // E[A] / sqrt(E[A^2])
  } cases[] = {{0.5, 0.70711}, {1, 0.78540}, {4, 0.85903}, {20, 0.88073}};
  for (const auto& [shape, amplitude] : cases) {
    SCOPED_TRACE(testing::Message() << "shape " << shape);
    const std::uint32_t n = 400000;
    const auto energies = draw({SpeckleModel::k, shape, 1}, 1, 0, n);
    expect_model(energies, [shape = shape](double x) { return k_distribution(shape, x); });
    // Moments <I^m> = m! (1 + 1/nu) ... (1 + (m-1)/nu) give the spread of the estimates.
    const double second = 2 * (1 + 1 / shape), third = 3 * second * (1 + 2 / shape),
                 fourth = 4 * third * (1 + 3 / shape);
    const double sigma = std::sqrt((second - 1) / n);
    EXPECT_NEAR(statistics::mean(energies), 1, 6 * sigma);
    const double spread = fourth - second * second - 4 * second * third + 4 * second * second * second;
    EXPECT_NEAR(statistics::scintillation(energies), second, 6 * std::sqrt(spread / n));
    std::vector<double> amplitudes;
    for (const double energy : energies) amplitudes.push_back(std::sqrt(energy));
    EXPECT_NEAR(statistics::mean(amplitudes), amplitude, 6 * std::sqrt((1 - amplitude * amplitude) / n));
  }
}

TEST(Speckle, LooksShareTheTextureOfTheirCell) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const double shape = 2;
  const int looks = 4;
  const auto energies = draw({SpeckleModel::k, shape, looks}, 1, 0, 200000);
  EXPECT_NEAR(statistics::scintillation(energies), (1 + 1 / shape) * (1 + 1.0 / looks), 0.04);
}

TEST(Speckle, NoiseAddsItsMeanUnderEveryLaw) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const double echo = 2, noise = 3;
  const std::uint32_t n = 200000;
  for (const SpeckleModel model : {SpeckleModel::none, SpeckleModel::rayleigh, SpeckleModel::k})
    EXPECT_NEAR(statistics::mean(draw({model, 1.5, 1}, echo, noise, n)), echo + noise, 0.08);
  // A speckled echo in noise: one complex Gaussian.
  auto energies = draw({SpeckleModel::rayleigh, 1, 1}, echo, noise, n);
  expect_model(energies, [&](double x) { return -std::expm1(-x / (echo + noise)); });
  // A steady echo in noise: a non-central chi-squared distribution with two degrees of freedom per look.
  for (const int looks : {1, 3}) {
    energies = draw({SpeckleModel::none, 1, looks}, echo, noise, n);
    const boost::math::non_central_chi_squared model(2 * looks, 2 * looks * echo / noise);
    expect_model(energies, [&](double x) { return cdf(model, 2 * looks * x / noise); });
  }
  // Noise alone has the distribution of speckle.
  expect_model(draw({}, 0, 1, n), [](double x) { return -std::expm1(-x); });
}

TEST(Speckle, NoiseWithoutAnEchoHasNoTexture) {
  for (std::uint32_t sample = 0; sample < 100; ++sample) {
    const SampleRandom random(seed, 1, 2, sample);
    EXPECT_EQ(received_energy(random, {SpeckleModel::k, 1.5, 2}, 0, 3),
              received_energy(random, {SpeckleModel::rayleigh, 1.5, 2}, 0, 3));
    EXPECT_EQ(lower_received_energy(random, {SpeckleModel::k, 1.5, 2}, 0, 0, 0, 3),
              lower_received_energy(random, {SpeckleModel::rayleigh, 1.5, 2}, 0, 0, 0, 3));
  }
}

TEST(Speckle, FirstValuesAreTheSameEverywhere) {
  // The words of Random123's first known answer, through -log(u).
  const double first = (double(0xe169c58d6627e8d5 >> 12) + 0.5) / double(1ull << 52);
  const double second = (double(0x9b00dbd8bc57ac4c >> 12) + 0.5) / double(1ull << 52);
  const SampleRandom random(0, 0, 0, 0);
  EXPECT_DOUBLE_EQ(received_energy(random, {SpeckleModel::rayleigh, 1, 1}, 3, 0), -3 * std::log(first));
  EXPECT_DOUBLE_EQ(received_energy(random, {SpeckleModel::rayleigh, 1, 2}, 3, 0),
                   -1.5 * std::log(first * second));
}

TEST(Speckle, TextureOfTinyShapeIsFinite) {
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const double texture = gamma_texture(SampleRandom(seed, 0, 0, i), 1e-3);
    EXPECT_TRUE(texture >= 0 && std::isfinite(texture)) << texture;
  }
}

/// Energies of both receivers of a pair in `n` range bins.
std::array<std::vector<double>, 2> draw_pair(const Speckle& speckle, double upper_j, double lower_j,
                                             double product_j, double noise_j, std::uint32_t n) {
  std::array<std::vector<double>, 2> pair;
  for (std::uint32_t i = 0; i < n; ++i) {
    const SampleRandom random(seed, i / 100000, i / 1000 % 100, i % 1000);
    pair[0].push_back(received_energy(random, speckle, upper_j, noise_j));
    pair[1].push_back(lower_received_energy(random, speckle, upper_j, lower_j, product_j, noise_j));
  }
  return pair;
}

// Siegert's relation: energies of Gaussian signals have the squared coherence as their correlation.
TEST(Speckle, OfAPairHasTheCoherenceOfItsSignals) {
  constexpr std::uint32_t n = 400000;
  for (const double coherence : {0.0, 0.5, 0.9, 1.0}) {
    SCOPED_TRACE(coherence);
    const auto [upper, lower] = draw_pair({SpeckleModel::rayleigh, 1, 1}, 1, 4, 2 * coherence, 0, n);
    std::vector<double> unit;
    for (const double energy : lower) unit.push_back(energy / 4);
    expect_model(unit, [](double x) { return 1 - std::exp(-x); });
    EXPECT_NEAR(statistics::correlation(upper, lower), coherence * coherence, 0.02);
    for (std::uint32_t i = 0; coherence == 1 && i < n; ++i)
      ASSERT_NEAR(lower[i], 4 * upper[i], 1e-7 * (1 + upper[i]));
  }
}

TEST(Speckle, NoiseOfAPairIsIndependent) {
  constexpr std::uint32_t n = 400000;
  const auto [upper, lower] = draw_pair({SpeckleModel::rayleigh, 1, 1}, 1, 1, 1, 1, n);
  EXPECT_NEAR(statistics::correlation(upper, lower), 0.25, 0.02);  // coherence 1 / (1 + 1)
  EXPECT_NEAR(statistics::mean(lower), 2, 0.02);
  const auto [steady, other] = draw_pair({}, 1, 3, std::sqrt(3), 0.5, n);
  EXPECT_NEAR(statistics::correlation(steady, other), 0, 0.02);
  EXPECT_NEAR(statistics::mean(other), 3.5, 0.02);
}

TEST(Speckle, OfAPairOverLooksAndTextureKeepsTheMean) {
  constexpr std::uint32_t n = 400000;
  const auto [upper, lower] = draw_pair({SpeckleModel::k, 2, 3}, 1, 2, std::sqrt(2), 0, n);
  EXPECT_NEAR(statistics::mean(lower), 2, 0.02);
  EXPECT_NEAR(statistics::correlation(upper, lower), 1, 1e-6);  // full coherence, common texture
  EXPECT_EQ(lower_received_energy(SampleRandom(1, 2, 3, 4), {}, 1, 1.0 / 3, 0.1, 0), 1.0 / 3);
  EXPECT_EQ(lower_received_energy(SampleRandom(1, 2, 3, 4), {SpeckleModel::k, 2, 1}, 1, 0, 0, 0), 0);
}

}  // namespace
}  // namespace tubefoot
