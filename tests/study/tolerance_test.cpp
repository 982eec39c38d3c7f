// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/tolerance.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace tubefoot {
namespace {

TEST(Tolerance, IsReadAsPeopleWriteIt) {
  const auto expect = [](const char* text, ErrorMeasure measure, double value) {
    const Tolerance t = parse_tolerance(text);
    EXPECT_EQ(t.measure, measure) << text;
    EXPECT_DOUBLE_EQ(t.value, value) << text;
  };
  expect("0.1dB", ErrorMeasure::rms_db, 0.1);
  expect("0.5 dB", ErrorMeasure::rms_db, 0.5);
  expect("3db", ErrorMeasure::rms_db, 3);
  expect("1e-3", ErrorMeasure::l1, 1e-3);
  expect("0.1%", ErrorMeasure::l1, 1e-3);
  expect("5 %", ErrorMeasure::l1, 0.05);
  expect("0.02", ErrorMeasure::l1, 0.02);
  expect("0.1", ErrorMeasure::l1, 0.1);
  expect("100%", ErrorMeasure::l1, 1);
}

TEST(Tolerance, WhatIsWrittenIsReadAgain) {
  for (const char* text : {"0.1dB", "0.001", "1e-05dB", "1e-06", "0.1", "50%", "3dB"})
    EXPECT_EQ(to_text(parse_tolerance(text)), text);
}

TEST(Tolerance, OtherTextIsRefusedWithWhatWasExpected) {
  for (const char* text :
       {"", "dB", "little", "0.1dBm", "0.1 d B", "1e-3%%", "%", "0,1dB", " 0.1dB", "0.1dB "})
    try {
      parse_tolerance(text);
      ADD_FAILURE() << "taken: '" << text << "'";
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(),
                  testing::HasSubstr("'" + std::string(text) + "' is not a tolerance: expected 0.1dB"));
    }
}

// 0.5 alone would be 50 %, which users hardly ever mean.
TEST(Tolerance, LargeOnesNeedAUnit) {
  for (const char* text : {"0.11", "0.5", "1", "5", "10"}) {
    const std::string said = testing::PrintToString(text);
    try {
      parse_tolerance(text);
      ADD_FAILURE() << "taken: " << said;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(),
                  testing::HasSubstr("'" + std::string(text) + "' without a unit is a relative error of "));
      EXPECT_THAT(error.what(), testing::HasSubstr(std::string(text) + "dB"));
    }
  }
}

TEST(Tolerance, WhatNoRunCanKeepIsRefused) {
  for (const char* text : {"nan", "nan%", "inf", "-1e-3", "0", "1e-7", "1.1", "101%", "1e-400"})
    EXPECT_THROW(parse_tolerance(text), std::invalid_argument) << text;
  for (const char* text : {"nandB", "infdB", "-0.1dB", "0dB", "1e-6dB", "31dB"})
    EXPECT_THROW(parse_tolerance(text), std::invalid_argument) << text;
}

TEST(SamplesFor, FollowThePowerLawOfTheLastTrials) {
  std::vector<Trial> ladder;
  for (const double n : {1.0, 100.0, 1000.0, 10000.0}) {
    Trial t;
    t.samples = n;
    t.l1_error = n == 1 ? 0.5 : 3 * std::pow(n, -0.75);  // the first has not converged
    ladder.push_back(t);
  }
  const auto samples = samples_for(ladder, ErrorMeasure::l1, 1e-4);
  ASSERT_TRUE(samples);
  EXPECT_NEAR(*samples, std::pow(3e4, 1 / 0.75), 1e-6 * *samples);
  EXPECT_FALSE(samples_for(ladder, ErrorMeasure::rms_db, 1e-4)) << "no errors, no law";
  EXPECT_FALSE(samples_for(std::span(ladder).first(1), ErrorMeasure::l1, 1e-4));
  for (Trial& t : ladder) t.l1_error = 0.2;
  EXPECT_FALSE(samples_for(ladder, ErrorMeasure::l1, 1e-4)) << "does not fall";
}

TEST(Tolerance, OfASingleEnergy) {
  EXPECT_EQ(relative_error(parse_tolerance("0.1%")), parse_tolerance("1e-3").value);
  EXPECT_NEAR(relative_error(parse_tolerance("3dB")), 0.4988127663727278, 1e-15);
  EXPECT_NEAR(relative_error(parse_tolerance("1e-5dB")), 2.3025824e-6, 1e-12);
  EXPECT_LT(relative_error(parse_tolerance("30dB")), 1);
}

}  // namespace
}  // namespace tubefoot
