// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the division of errors of shared bins. No error is lost, and an error of one owner is attributed to
// this owner alone.
#include "compare/attribution/error_split.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tubefoot {
namespace {

constexpr std::size_t owners = 3, groups = 2;

struct Sums {
  ErrorSums all;
  std::array<ErrorSums, owners> by_owner;
  std::array<ErrorSums, groups> by_group;

  explicit Sums(const std::vector<ErrorSums>& table) {
    EXPECT_EQ(table.size(), owners * groups);
    for (std::size_t k = 0; k < table.size(); ++k) {
      all += table[k];
      by_owner.at(k / groups) += table[k];
      by_group.at(k % groups) += table[k];
    }
  }
};

TEST(ErrorSplit, AddsUpToTheWholeWhateverTheBins) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> within(0, 1);
  ErrorSplit split(groups);
  ErrorSums whole;
  std::array<ErrorSums, groups> by_group;
  for (int bin = 0; bin < 500; ++bin) {
    const double a = within(random), b = within(random) * (1 - a), reference = within(random),
                 candidate = within(random);
    const ErrorSums sums{std::abs(candidate - reference), candidate - reference, reference};
    const std::size_t group = bin % 2;
    split.add(group, std::vector<OwnerShare>{{0, a}, {2, b}, {1, 1 - a - b}}, sums);
    split.add(group, std::vector<OwnerShare>{{2, 1}}, sums);
    whole += sums;
    whole += sums;
    by_group.at(group) += sums;
    by_group.at(group) += sums;
  }
  const Sums found(split.finish(owners));
  EXPECT_NEAR(found.all.error, whole.error, 1e-9);
  EXPECT_NEAR(found.all.difference, whole.difference, 1e-9);
  EXPECT_NEAR(found.all.energy, whole.energy, 1e-9);
  for (std::size_t group = 0; group < groups; ++group)
    EXPECT_NEAR(found.by_group.at(group).error, by_group.at(group).error, 1e-9);
}

TEST(ErrorSplit, FindsTheOneThatIsWrongInBinsOfSeveral) {
  // Owner 1 is 50 % too strong, and the others are correct. In each shared bin the error is half of the
  // share of owner 1.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> within(0, 1);
  ErrorSplit split(groups);
  double error = 0;
  for (int bin = 0; bin < 300; ++bin) {
    const double share = within(random);
    split.add(0, std::vector<OwnerShare>{{0, 1 - share}, {1, share}}, {share / 2, share / 2, 1});
    error += share / 2;
    split.add(1, std::vector<OwnerShare>{{0, 1}}, {0, 0, 1});
    split.add(1, std::vector<OwnerShare>{{2, 1}}, {0, 0, 1});
  }
  const Sums found(split.finish(owners));
  EXPECT_NEAR(found.by_owner[1].error / error, 1, 1e-6);
  EXPECT_NEAR(found.by_owner[1].difference / error, 1, 1e-6);
  EXPECT_EQ(found.by_owner[2].error, 0);
}

TEST(ErrorSplit, WithoutRoundsSplitsByEnergy) {
  ErrorSplit split(1);
  split.add(0, std::vector<OwnerShare>{{0, 0.25}, {1, 0.75}}, {8, -8, 16});
  const std::vector<ErrorSums> table = split.finish(2, 0);
  EXPECT_DOUBLE_EQ(table[0].error, 2);
  EXPECT_DOUBLE_EQ(table[1].error, 6);
  EXPECT_DOUBLE_EQ(table[1].difference, -6);
  EXPECT_DOUBLE_EQ(table[1].energy, 12);
}

TEST(ErrorSplit, OfNothingIsNothing) {
  ErrorSplit split(2);
  split.add(1, std::vector<OwnerShare>{{0, 0.5}, {1, 0.5}}, {0, 0, 0});
  for (const ErrorSums& sums : split.finish(3)) {
    EXPECT_EQ(sums.error, 0);
    EXPECT_EQ(sums.energy, 0);
  }
}

}  // namespace
}  // namespace tubefoot
