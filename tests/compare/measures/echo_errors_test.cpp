// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the error measures with figures that were worked out by hand from docs/compared-figures.md, and
// tests their laws.
#include "compare/measures/echo_errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Optional;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Owns the data of a pair. Samples are 0.5 m apart from 2 m on.
struct Case {
  EchoShape shape;
  std::vector<double> reference, candidate, bound = {}, ranges = {};

  EchoErrors errors(std::size_t worst = 0) {
    ranges.clear();
    for (std::size_t k = 0; k < shape.samples; ++k) ranges.push_back(2 + 0.5 * double(k));
    return echo_errors({shape, reference, candidate, bound, ranges}, worst);
  }
};

TEST(EchoErrors, FourBinsWorkedOutByHand) {
  // The mean of the energies above 0 is (4 + 2 + 0.001) / 3 = 2.000333, so that the third bin is not lit.
  Case four{{1, 1, 4}, {4, 2, 0.001, 0}, {2, 0, 5, 1}};
  const EchoErrors errors = four.errors();
  EXPECT_DOUBLE_EQ(errors.reference_total_j, 6.001);
  EXPECT_DOUBLE_EQ(errors.candidate_total_j, 8);
  EXPECT_DOUBLE_EQ(errors.lit_threshold_j, 6.001e-3 / 3);
  EXPECT_EQ(errors.lit_bins, 2u);
  EXPECT_EQ(errors.shadow_bins, 1u);
  EXPECT_DOUBLE_EQ(errors.l1, (2 + 2 + 4.999 + 1) / 6.001);
  EXPECT_DOUBLE_EQ(errors.energy_ratio, 8 / 6.001);
  const double half_db = 10 * std::log10(0.5);
  EXPECT_DOUBLE_EQ(errors.rms_db, std::sqrt((half_db * half_db + 30 * 30) / 2));
  EXPECT_EQ(errors.empty_where_lit, 1u);
  EXPECT_EQ(errors.lit_where_shadow, 1u);
  EXPECT_FALSE(errors.within_bound);
  EXPECT_THAT(errors.worst, IsEmpty());
}

TEST(EchoErrors, DecibelErrorIsClampedAtThirty) {
  EXPECT_EQ(decibel_error(3, 3), 0);
  EXPECT_EQ(decibel_error(0, 0), 0);
  EXPECT_DOUBLE_EQ(decibel_error(1, 100), 20);
  EXPECT_DOUBLE_EQ(decibel_error(100, 1), -20);
  EXPECT_EQ(decibel_error(1, 1e4), 30);
  EXPECT_EQ(decibel_error(1e4, 1), -30);
  EXPECT_EQ(decibel_error(1, 0), -30);
  EXPECT_EQ(decibel_error(0, 1), 30);
  EXPECT_EQ(decibel_error(1e-320, 1e300), 30) << "the ratio overflows";
}

TEST(EchoErrors, LitIsAboveAThousandthOfTheMeanOverBinsWithEcho) {
  EXPECT_DOUBLE_EQ(lit_threshold(std::vector<double>{0, 3, 0, 1, 0, 0}), 2e-3);
  EXPECT_EQ(lit_threshold(std::vector<double>{0, 0}), 0);
  EXPECT_EQ(lit_threshold({}), 0);
  // A bin exactly at the threshold is not lit: half of these bins have 1, the others t = 1e-3 (1 + t) / 2.
  const double t = 1e-3 / (2 - 1e-3);
  for (const double weak : {t * (1 - 1e-9), t * (1 + 1e-9)}) {
    Case pair{{1, 1, 2}, {1, weak}, {1, weak}};
    EXPECT_EQ(pair.errors().lit_bins, weak > t ? 2u : 1u);
  }
}

TEST(EchoErrors, ACandidateBelowTheThresholdLightsNoShadow) {
  Case pair{{1, 1, 3}, {1, 0, 0}, {1, 0.9e-3, 1.1e-3}};
  EXPECT_EQ(pair.errors().lit_where_shadow, 1u);
}

TEST(EchoErrors, SilenceOnOneSideOrBoth) {
  Case both{{1, 1, 2}, {0, 0}, {0, 0}}, reference{{1, 1, 2}, {0, 0}, {0, 3}},
      candidate{{1, 1, 2}, {0, 3}, {0, 0}};
  EXPECT_EQ(both.errors().l1, 0);
  EXPECT_EQ(both.errors().energy_ratio, 1);
  EXPECT_EQ(both.errors().rms_db, 0);
  EXPECT_EQ(reference.errors().l1, infinity);
  EXPECT_EQ(reference.errors().energy_ratio, infinity);
  EXPECT_EQ(reference.errors().lit_where_shadow, 1u);
  EXPECT_EQ(candidate.errors().l1, 1);
  EXPECT_EQ(candidate.errors().energy_ratio, 0);
  EXPECT_EQ(candidate.errors().rms_db, 30);
}

TEST(EchoErrors, WorstBinsHavePlacesInOrderOfTheirDifference) {
  Case pair{{3, 2, 2}, {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}, {1, 1, 1, 1, 1, 1, 3, 1, 0, 1, 1, 2}};
  const auto worst = pair.errors(10).worst;
  ASSERT_EQ(worst.size(), 3u) << "bins that agree are not among the worst";
  EXPECT_EQ(worst[0].place, (BinPlace{1, 1, 0}));
  EXPECT_EQ(worst[1].place, (BinPlace{2, 0, 0}));  // as large as the next one, and before it
  EXPECT_EQ(worst[2].place, (BinPlace{2, 1, 1}));
  EXPECT_EQ(worst[2].slant_range_m, 2.5);
  EXPECT_EQ(worst[0].reference_j, 1);
  EXPECT_EQ(worst[0].candidate_j, 3);
  EXPECT_DOUBLE_EQ(worst[0].error_db, 10 * std::log10(3));
  EXPECT_EQ(worst[0].share_of_difference, 0.5);
  EXPECT_EQ(worst[1].error_db, -30);
  EXPECT_EQ(worst[1].share_of_difference, 0.25);
  EXPECT_EQ(pair.errors(1).worst.size(), 1u);
}

TEST(EchoErrors, FirstReturnIsTheFirstLitSample) {
  const std::vector<double> energy{0, 0.001, 5, 6, 0, 0, 0, 0, 7, 0, 0, 0};
  EXPECT_THAT(first_returns({1, 3, 4}, energy, 0.001), ElementsAre(Optional(2u), std::nullopt, Optional(0u)));
}

TEST(EchoErrors, FirstReturnDifferencesHaveSignPlaceAndCounts) {
  // Two pings of three beams with four samples. The first lit samples are
  // reference  1 0 -   3 - 2
  // candidate  3 0 1   2 - -
  Case pair{{2, 3, 4},
            {0, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0},
            {0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0}};
  const FirstReturnErrors first = pair.errors().first_return;
  EXPECT_EQ(first.in_both, 3u);
  EXPECT_EQ(first.only_in_reference, 1u);
  EXPECT_EQ(first.only_in_candidate, 1u);
  EXPECT_EQ(first.in_neither, 1u);
  EXPECT_DOUBLE_EQ(first.mean_m, (1 + 0 - 0.5) / 3);
  EXPECT_DOUBLE_EQ(first.mean_absolute_m, (1 + 0 + 0.5) / 3);
  EXPECT_DOUBLE_EQ(first.mean_absolute_samples, 1);
  EXPECT_DOUBLE_EQ(first.largest_m, 1);
  EXPECT_EQ(first.largest_samples, 2);
  EXPECT_EQ(first.largest_at, (BinPlace{0, 0, 1}));
  std::swap(pair.reference, pair.candidate);
  EXPECT_EQ(pair.errors().first_return.only_in_reference, 1u);
  EXPECT_DOUBLE_EQ(pair.errors().first_return.largest_m, -1);
  EXPECT_EQ(pair.errors().first_return.largest_samples, -2);
}

TEST(EchoErrors, LargestOfEqualFirstReturnDifferencesIsTheFirst) {
  Case pair{{1, 2, 3}, {1, 1, 1, 0, 1, 0}, {0, 1, 0, 1, 0, 0}};
  const FirstReturnErrors first = pair.errors().first_return;
  EXPECT_DOUBLE_EQ(first.largest_m, 0.5);
  EXPECT_EQ(first.largest_samples, 1);
  EXPECT_EQ(first.largest_at, (BinPlace{0, 0, 0}));
}

TEST(EchoErrors, BoundExplainsWhatItReaches) {
  // Differences 0.5, 3, 0, 0.25 against bounds 1, 1, 1, 0: explained 0.5 + 1 + 0 + 0 of 3.75. The last bin
  // has no echo on either side and does not count.
  Case pair{{1, 1, 5}, {4, 4, 2, 0, 0}, {4.5, 1, 2, 0.25, 0}, {1, 1, 1, 0, 0}};
  const auto within = pair.errors().within_bound;
  ASSERT_TRUE(within);
  EXPECT_DOUBLE_EQ(within->bound_l1, 0.3);
  EXPECT_DOUBLE_EQ(within->share_of_difference, 0.4);
  EXPECT_DOUBLE_EQ(within->share_of_bins, 0.5);
}

TEST(EchoErrors, BoundReachedExactlyHolds) {
  Case pair{{1, 1, 2}, {4, 4}, {5, 3}, {1, 1}};
  EXPECT_EQ(pair.errors().within_bound->share_of_bins, 1);
  EXPECT_EQ(pair.errors().within_bound->share_of_difference, 1);
  pair.bound = {infinity, 0};
  EXPECT_EQ(pair.errors().within_bound->bound_l1, infinity);
  EXPECT_EQ(pair.errors().within_bound->share_of_difference, 0.5);
  EXPECT_EQ(pair.errors().within_bound->share_of_bins, 0.5);
}

TEST(EchoErrors, ArraysOfOtherLengthsAreRefused) {
  const std::vector<double> six(6, 1.0), five(5, 1.0), ranges{1, 2, 3};
  const EchoShape shape{1, 2, 3};
  EXPECT_NO_THROW(echo_errors({shape, six, six, {}, ranges}));
  EXPECT_THROW(echo_errors({shape, five, six, {}, ranges}), std::invalid_argument);
  EXPECT_THROW(echo_errors({shape, six, five, {}, ranges}), std::invalid_argument);
  EXPECT_THROW(echo_errors({shape, six, six, five, ranges}), std::invalid_argument);
  EXPECT_THROW(echo_errors({shape, six, six, {}, six}), std::invalid_argument);
}

/// Random echoes over many orders of magnitude, a third of them shadow.
struct EchoErrorLaws : testing::TestWithParam<unsigned> {
  std::mt19937 random{GetParam()};
  Case pair{{3, 5, 40}, energies(), energies()};

  std::vector<double> energies() {
    std::uniform_real_distribution<double> exponent(-14, -6);
    std::vector<double> result;
    for (int k = 0; k < 600; ++k) result.push_back(random() % 3 == 0 ? 0 : std::pow(10, exponent(random)));
    return result;
  }
};

TEST_P(EchoErrorLaws, EqualSidesHaveNoError) {
  pair.candidate = pair.reference;
  pair.bound.assign(600, 0);
  const EchoErrors errors = pair.errors(10);
  EXPECT_EQ(errors.l1, 0);
  EXPECT_EQ(errors.rms_db, 0);
  EXPECT_EQ(errors.energy_ratio, 1);
  EXPECT_EQ(errors.empty_where_lit, 0u);
  EXPECT_EQ(errors.lit_where_shadow, 0u);
  EXPECT_EQ(errors.first_return.mean_absolute_m, 0);
  EXPECT_EQ(errors.first_return.only_in_reference + errors.first_return.only_in_candidate, 0u);
  EXPECT_EQ(errors.within_bound->share_of_difference, 1);
  EXPECT_EQ(errors.within_bound->share_of_bins, 1);
  EXPECT_THAT(errors.worst, IsEmpty());
}

TEST_P(EchoErrorLaws, TwiceTheEnergyIsThreeDecibels) {
  for (const double factor : {2.0, 0.5}) {
    for (std::size_t k = 0; k < 600; ++k) pair.candidate[k] = factor * pair.reference[k];
    const EchoErrors errors = pair.errors();
    EXPECT_DOUBLE_EQ(errors.energy_ratio, factor);
    EXPECT_DOUBLE_EQ(errors.l1, std::abs(factor - 1));
    EXPECT_NEAR(errors.rms_db, 3.0103, 1e-5);
    EXPECT_EQ(errors.empty_where_lit, 0u);
    EXPECT_EQ(errors.lit_where_shadow, 0u);
  }
}

TEST_P(EchoErrorLaws, UnitsOfEnergyDoNotMatter) {
  const EchoErrors before = pair.errors(3);
  for (auto* side : {&pair.reference, &pair.candidate})
    for (double& energy : *side) energy *= 1024;
  const EchoErrors after = pair.errors(3);
  EXPECT_EQ(after.l1, before.l1);
  EXPECT_EQ(after.rms_db, before.rms_db);
  EXPECT_EQ(after.lit_bins, before.lit_bins);
  EXPECT_EQ(after.lit_where_shadow, before.lit_where_shadow);
  EXPECT_EQ(after.worst[2].place, before.worst[2].place);
}

TEST_P(EchoErrorLaws, DifferenceIsSymmetric) {
  const EchoErrors forward = pair.errors(5);
  std::swap(pair.reference, pair.candidate);
  const EchoErrors backward = pair.errors(5);
  EXPECT_NEAR(forward.l1 * forward.reference_total_j, backward.l1 * backward.reference_total_j,
              1e-12 * forward.reference_total_j);
  EXPECT_NEAR(forward.energy_ratio * backward.energy_ratio, 1, 1e-12);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(forward.worst[k].place, backward.worst[k].place);
    EXPECT_NEAR(forward.worst[k].error_db, -backward.worst[k].error_db, 1e-9);
  }
}

TEST_P(EchoErrorLaws, CountsAddUpAndSharesAreShares) {
  pair.bound = energies();
  const EchoErrors errors = pair.errors(600);
  const FirstReturnErrors& first = errors.first_return;
  EXPECT_EQ(first.in_both + first.only_in_reference + first.only_in_candidate + first.in_neither, 15u);
  EXPECT_LE(errors.empty_where_lit, errors.lit_bins);
  EXPECT_LE(errors.lit_where_shadow, errors.shadow_bins);
  EXPECT_LE(errors.rms_db, 30);
  double shares = 0;
  for (const BinError& bin : errors.worst) shares += bin.share_of_difference;
  EXPECT_NEAR(shares, 1, 1e-12);
  EXPECT_GT(errors.within_bound->share_of_difference, 0);
  EXPECT_LT(errors.within_bound->share_of_difference, 1);
  // For a candidate that is moved by exactly the bound, the bound explains the whole error. For twice the
  // bound it explains half.
  for (const double times : {1.0, 2.0}) {
    for (std::size_t k = 0; k < 600; ++k) {
      pair.bound[k] = std::ldexp(pair.reference[k], -10);  // sums without rounding
      pair.candidate[k] = pair.reference[k] + times * pair.bound[k];
    }
    EXPECT_NEAR(pair.errors().within_bound->share_of_difference, 1 / times, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, EchoErrorLaws, testing::Range(1u, 9u));

}  // namespace
}  // namespace tubefoot
