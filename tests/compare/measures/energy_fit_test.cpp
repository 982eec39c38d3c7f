// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that the fit recovers the applied gain, range law and offset, with error bars that contain the true
// values.
#include "compare/measures/energy_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "compare/measures/unitless_errors.hpp"
#include "files/usage_error.hpp"

namespace tubefoot {
namespace {

/// A fan of a plane with a shadow: energies fall as r^-3, samples of 5 cm from 4 m on.
struct Fan {
  EchoShape shape{1, 48, 160};
  std::vector<double> ranges, reference, candidate;

  Fan() {
    for (std::size_t s = 0; s < shape.samples; ++s) ranges.push_back(4 + 0.05 * double(s));
    for (std::size_t b = 0; b < shape.beams; ++b)
      for (std::size_t s = 0; s < shape.samples; ++s) {
        const bool dark = s < 10 || (b >= 18 && b < 30 && s >= 60 && s < 110);
        reference.push_back(dark ? 0
                                 : 1e-9 * std::pow(ranges[s], -3) * (1 + 0.3 * std::sin(0.4 * double(b))));
      }
    candidate = reference;
  }
  void put_on(double gain, double exponent, double offset) {
    for (std::size_t k = 0; k < candidate.size(); ++k)
      candidate[k] = candidate[k] * gain * std::pow(ranges[k % shape.samples], exponent) + offset;
  }
  EchoPair pair() const { return {shape, reference, candidate, {}, ranges}; }
  EnergyFit fit(const std::string& terms) const { return fit_energies(pair(), fit_terms(terms)).value(); }
  double l1_after(const std::string& terms) const {
    const std::vector<double> fitted = fit(terms).fitted(pair());
    return echo_errors({shape, reference, fitted, {}, ranges}).l1;
  }
};

TEST(EnergyFit, FindsWhatWasPutOnExactly) {
  Fan fan;
  fan.put_on(4.7e7, 1.5, 1e-5);
  const EnergyFit fit = fan.fit("gain,range,offset");
  EXPECT_NEAR(fit.exponent.value, 1.5, 1e-6);
  EXPECT_NEAR(fit.gain_db.value, 10 * std::log10(4.7e7 * std::pow(fit.middle_range_m, 1.5)), 1e-5);
  EXPECT_NEAR(fit.offset_j.value, 1e-5, 1e-12);
  EXPECT_LT(fan.l1_after("gain,range,offset"), 1e-6);
  EXPECT_GT(fan.l1_after("gain"), 0.1);
}

TEST(EnergyFit, EachTermAlone) {
  Fan gain, range, offset;
  gain.put_on(1e-6, 0, 0);
  EXPECT_NEAR(gain.fit("gain").gain_db.value, -60, 1e-9);
  EXPECT_LT(gain.l1_after("gain"), 1e-9);
  range.put_on(1, -2, 0);
  const double middle_m = range.fit("range").middle_range_m;
  for (double& e : range.candidate) e *= middle_m * middle_m;  // 1 at the middle range: no gain is needed
  EXPECT_NEAR(range.fit("range").exponent.value, -2, 1e-6);
  offset.put_on(1, 0, 3e-12);
  EXPECT_LT(offset.l1_after("offset"), 1e-9);
  EXPECT_EQ(offset.fit("offset").gain_db.value, 0);
}

TEST(EnergyFit, ErrorBarsHoldUnderNoiseOfSampling) {
  int inside_gain = 0, inside_law = 0;
  double worst = 0;
  constexpr int trials = 100;
  for (int seed = 0; seed < trials; ++seed) {
    Fan fan;
    std::mt19937 random(static_cast<unsigned>(seed));
    for (double& e : fan.candidate)
      if (e > 0) e *= std::poisson_distribution<int>(8)(random) / 8.0;
    const EnergyFit fit = fan.fit("gain,range");
    inside_gain += std::abs(fit.gain_db.value) < 2 * fit.gain_db.error;
    inside_law += std::abs(fit.exponent.value) < 2 * fit.exponent.error;
    worst = std::max(worst, std::abs(fit.gain_db.value));
  }
  EXPECT_GE(inside_gain, 85);
  EXPECT_GE(inside_law, 85);
  EXPECT_LT(worst, 0.15);
}

TEST(EnergyFit, AMissingShadowDoesNotMoveIt) {
  Fan fan;
  for (std::size_t b = 18; b < 30; ++b)
    for (std::size_t s = 60; s < 110; ++s)
      fan.candidate[b * fan.shape.samples + s] = 1e-9 * std::pow(fan.ranges[s], -3);
  EXPECT_NEAR(fan.fit("gain,range").gain_db.value, 0, 0.15);
  EXPECT_NEAR(fan.fit("gain,range").exponent.value, 0, 0.1);
}

TEST(EnergyFit, NothingToFitIsSaid) {
  Fan silent;
  silent.candidate.assign(silent.candidate.size(), 0);
  EXPECT_FALSE(fit_energies(silent.pair(), fit_terms("gain")));
  for (const char* words : {"", "gian", "gain,gain", "gain;range"})
    EXPECT_THROW(fit_terms(words), UsageError);
}

TEST(UnitlessErrors, GainsDropOut) {
  Fan fan;
  for (std::size_t k = 0; k < fan.candidate.size(); ++k)
    fan.candidate[k] *= 1 + 7 * std::abs(std::sin(double(k % fan.shape.samples)));
  EXPECT_NEAR(unitless_errors(fan.pair()).row_l1, 0, 1e-12) << "each row has its own gain";
  EXPECT_LT(unitless_errors(fan.pair()).rank_correlation, 0.99);
  for (std::size_t k = 0; k < fan.candidate.size(); ++k) fan.candidate[k] = std::sqrt(fan.reference[k]);
  EXPECT_NEAR(unitless_errors(fan.pair()).rank_correlation, 1, 1e-12) << "the order is kept";
  EXPECT_GT(unitless_errors(fan.pair()).row_l1, 0.01);
}

TEST(UnitlessErrors, FourBinsByHand) {
  // Rows of two beams: (1, 3) against (3, 1), and (0, 2) against (0, 0).
  const std::vector<double> reference{1, 0, 3, 2}, candidate{3, 0, 1, 0}, ranges{1, 2};
  const UnitlessErrors errors = unitless_errors({{1, 2, 2}, reference, candidate, {}, ranges});
  EXPECT_DOUBLE_EQ(errors.row_l1, 1);
  EXPECT_EQ(errors.rows, 1u);
  EXPECT_EQ(errors.rows_of_one_side, 1u);
  EXPECT_DOUBLE_EQ(errors.rank_correlation, -0.5) << "ranks 0 2 1 against 2 1 0";
}

}  // namespace
}  // namespace tubefoot
