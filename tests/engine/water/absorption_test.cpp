// SPDX-License-Identifier: GPL-3.0-or-later
// Tests absorption formulas: Francois and Garrison with published check values and tables, and Ainslie and
// McColm with their table.

#include "engine/water/absorption.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tubefoot {
namespace {

double absorption(double khz, double t = 10, double s = 35, double d = 0, double ph = 8) {
  return francois_garrison_absorption_db_per_km(khz, t, s, d, ph);
}

TEST(FrancoisGarrison, PublishedCheckValues) {
  EXPECT_NEAR(absorption(200), 54.446199, 1e-6);
  EXPECT_NEAR(francois_garrison_absorption_db_per_km(200, 10, 35, 0, 8, 1500), 54.047064, 1e-6);
  EXPECT_NEAR(absorption(200, 10, 35, 4000), 32.836398, 1e-6);
  EXPECT_NEAR(absorption(31.23), 7.354640, 1e-6);
  EXPECT_NEAR(absorption(200, 10, 35, 0, 7.8), 54.411284, 1e-6);
  EXPECT_NEAR(absorption(200, 10, 15.000012), 31.259585, 1e-6);
  EXPECT_NEAR(absorption(200, 0.2), 40.702235, 1e-6);
}

TEST(FrancoisGarrison, KelvinOffsetIs273AsInThePaper) {
  // With 273.15 the value would be 54.7158, with an error of half a per cent.
  EXPECT_GT(std::abs(absorption(200) - 54.7158), 0.2);
}

TEST(FrancoisGarrison, CoarsePublishedBounds) {
  EXPECT_NEAR(absorption(10, 15), 1, 0.5);
  EXPECT_NEAR(absorption(50, 27), 11, 0.5);
  EXPECT_NEAR(absorption(100, 27), 36, 0.5);
  EXPECT_NEAR(absorption(100, 14, 38.5, 0), 40, 0.5);
  EXPECT_NEAR(absorption(100, 14, 38.5, 2000), 30, 0.5);
  EXPECT_NEAR(absorption(100, 14, 38.5, 6000), 16, 0.5);
}

TEST(FrancoisGarrison, FrequencyTable) {
  const struct {
    double khz, db_per_km;
  } rows[] = {{12, 1.326},     {30, 6.858},     {38, 10.151},     {70, 23.629},    {100, 33.584},
              {120, 38.771},   {200, 54.379},   {240, 61.522},    {300, 73.062},   {400, 96.026},
              {455, 111.004},  {500, 124.574},  {700, 199.659},   {900, 299.296},  {1000, 358.389},
              {1100, 423.679}, {1200, 495.172}, {1800, 1054.504}, {3000, 2844.081}};
  for (const auto& row : rows) EXPECT_NEAR(absorption(row.khz, 10, 35, 10), row.db_per_km, 6e-4) << row.khz;
}

TEST(FrancoisGarrison, TemperatureTable) {
  const double khz[] = {100, 240, 455, 1100, 1800};
  const struct {
    double t;
    double db_per_km[5];
  } rows[] = {{0, {23.407, 49.495, 123.697, 618.827, 1620.674}},
              {4, {27.500, 51.970, 113.284, 518.384, 1337.658}},
              {15, {37.032, 73.772, 119.633, 382.498, 909.540}},
              {20, {38.005, 87.861, 135.836, 362.700, 810.196}},
              {25, {36.627, 101.273, 158.805, 363.380, 751.688}}};
  for (const auto& row : rows)
    for (int i = 0; i < 5; ++i)
      EXPECT_NEAR(absorption(khz[i], row.t, 35, 10), row.db_per_km[i], 6e-4) << row.t << ' ' << khz[i];
}

TEST(FrancoisGarrison, FreshWater) {
  EXPECT_NEAR(absorption(240, 10, 0, 10, 7), 17.895, 6e-4);
  EXPECT_NEAR(absorption(700, 10, 0, 10, 7), 152.234, 6e-4);
  EXPECT_NEAR(absorption(1100, 10, 0, 10, 7), 375.924, 6e-4);
  EXPECT_NEAR(absorption(1200, 10, 0, 10, 7), 447.381, 6e-4);
  EXPECT_NEAR(absorption(1800, 10, 0, 10, 7), 1006.607, 1e-3);
}

TEST(FrancoisGarrison, BranchesOfPureWaterMeetAtTwentyDegrees) {
  const double below = absorption(1800, 20), above = absorption(1800, 20 + 1e-9);
  EXPECT_NE(below, above);
  EXPECT_NEAR(above / below, 1, 1e-3);
}

TEST(AinslieMcColm, FrequencyTable) {
  const struct {
    double khz, db_per_km;
  } rows[] = {{12, 1.357},     {30, 7.005},     {38, 10.364},     {70, 24.107},    {100, 34.288},
              {120, 39.627},   {200, 55.987},   {240, 63.621},    {300, 76.057},   {400, 100.948},
              {455, 117.218},  {500, 131.968},  {700, 213.645},   {900, 322.067},  {1000, 386.377},
              {1100, 457.433}, {1200, 535.240}, {1800, 1143.991}, {3000, 3091.706}};
  for (const auto& row : rows)
    EXPECT_NEAR(ainslie_mccolm_absorption_db_per_km(row.khz, 10, 35, 10, 8), row.db_per_km, 6e-4) << row.khz;
}

TEST(AinslieMcColm, AgreesWithFrancoisGarrison) {
  double largest = 0;
  for (double khz = 10; khz <= 1000; khz *= 1.01) {
    for (double t = 0; t <= 30; ++t) {
      const double fg = absorption(khz, t, 35, 10);
      largest = std::max(largest, std::abs(ainslie_mccolm_absorption_db_per_km(khz, t, 35, 10, 8) / fg - 1));
    }
  }
  EXPECT_NEAR(largest, 0.085, 1e-3);
  EXPECT_NEAR(ainslie_mccolm_absorption_db_per_km(1100, 0, 35, 10, 8) / absorption(1100, 0, 35, 10), 0.993,
              6e-4);
  EXPECT_NEAR(ainslie_mccolm_absorption_db_per_km(1800, 20, 35, 10, 8) / absorption(1800, 20, 35, 10), 1.061,
              6e-4);
}

}  // namespace
}  // namespace tubefoot
