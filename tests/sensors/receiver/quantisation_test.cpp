// SPDX-License-Identifier: GPL-3.0-or-later
// Tests quantisers of file formats: codes of levels and amplitudes, rounding, limits, inverses, and error
// bounds.

#include "sensors/receiver/quantisation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

TEST(Quantiser, DidsonSpreads90DecibelsOver256Codes) {
  const Quantiser didson = Quantiser::didson();
  EXPECT_EQ(didson.code(0), 0);
  EXPECT_EQ(didson.code(90), 255);
  EXPECT_EQ(didson.code(30), 85);
  EXPECT_DOUBLE_EQ(didson.value(85), 30);
  EXPECT_DOUBLE_EQ(didson.value(255), 90);
  EXPECT_DOUBLE_EQ(didson.error_bound(), 90.0 / 510);
  EXPECT_EQ(Quantiser::didson(100).code(130), 85);
}

TEST(Quantiser, ArisSpreads80DecibelsOver256Codes) {
  const Quantiser aris = Quantiser::aris();
  EXPECT_EQ(aris.code(80), 255);
  EXPECT_EQ(aris.code(16), 51);
  EXPECT_DOUBLE_EQ(aris.value(51), 16);
  EXPECT_DOUBLE_EQ(aris.error_bound(), 80.0 / 510);
}

TEST(Quantiser, XtfAmplitudesAndLevelsHave65536Codes) {
  const Quantiser amplitude = Quantiser::xtf_amplitude(65535);  // a step of 1
  for (const int code : {0, 1, 2, 32767, 32768, 65534, 65535}) {
    EXPECT_EQ(amplitude.code(code), code);
    EXPECT_EQ(amplitude.value(static_cast<std::uint16_t>(code)), code);
  }
  const Quantiser level = Quantiser::xtf_levels(-65535, 65535);  // a step of 2
  EXPECT_EQ(level.code(-65535), 0);
  EXPECT_EQ(level.code(65535), 65535);
  EXPECT_EQ(level.code(0), 32768);  // half way between two codes
  EXPECT_EQ(level.error_bound(), 1);
}

TEST(Quantiser, HalvesGoUpAndOneBitLessGoesDown) {
  const Quantiser unit(0, 255, 8);  // a step of 1: borders at halves are exact doubles
  for (int code = 0; code < 255; ++code) {
    EXPECT_EQ(unit.code(code + 0.5), code + 1);
    EXPECT_EQ(unit.code(std::nextafter(code + 0.5, 0)), code);
  }
  EXPECT_EQ(unit.code(0.25), 0);
  const Quantiser shifted(-8, 247, 8);
  EXPECT_EQ(shifted.code(-7.5), 1);
  EXPECT_EQ(shifted.code(-7.75), 0);
}

TEST(Quantiser, WhatLiesOutsideIsHeldAtTheEnds) {
  for (const Quantiser& q : {Quantiser::didson(), Quantiser::aris(), Quantiser::xtf_amplitude(1e-3),
                             Quantiser::xtf_levels(-100, 20)}) {
    EXPECT_EQ(q.code(-infinite), 0);  // no echo at all
    EXPECT_EQ(q.code(-1e300), 0);
    EXPECT_EQ(q.code(std::nextafter(q.value(0), -infinite)), 0);
    EXPECT_EQ(q.code(std::nextafter(q.value(q.largest_code()), infinite)), q.largest_code());
    EXPECT_EQ(q.code(1e300), q.largest_code());
    EXPECT_EQ(q.code(infinite), q.largest_code());
  }
}

TEST(Quantiser, InverseIsRightAndTheErrorBounded) {
  const unsigned seed = 20261121;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  for (const Quantiser& q : {Quantiser::didson(20), Quantiser::aris(), Quantiser::xtf_amplitude(3e7),
                             Quantiser::xtf_levels(-100, 20), Quantiser(0, 1, 1)}) {
    for (unsigned code = 0; code <= q.largest_code(); ++code)
      ASSERT_EQ(q.code(q.value(static_cast<std::uint16_t>(code))), code);
    const double bottom = q.value(0), span = q.value(q.largest_code()) - bottom;
    double worst = 0, before = bottom;
    for (int i = 0; i < 20000; ++i) {
      const double value = bottom + span * (static_cast<double>(random() >> 11) * 0x1p-53);
      worst = std::max(worst, std::abs(q.value(q.code(value)) - value));
      ASSERT_LE(q.code(std::min(before, value)), q.code(std::max(before, value)));  // it never decreases
      before = value;
    }
    EXPECT_LE(worst, q.error_bound() * (1 + 1e-9));
    EXPECT_GT(worst, q.error_bound() * 0.99);  // and the bound is attained
  }
}

TEST(Quantiser, RefusesWhatHasNoCode) {
  EXPECT_THROW(Quantiser::didson().code(std::nan("")), std::invalid_argument);
  EXPECT_THROW(Quantiser(0, 0, 8), std::invalid_argument);
  EXPECT_THROW(Quantiser(1, 0, 8), std::invalid_argument);
  EXPECT_THROW(Quantiser(0, infinite, 8), std::invalid_argument);
  EXPECT_THROW(Quantiser(-infinite, 0, 8), std::invalid_argument);
  EXPECT_THROW(Quantiser(std::nan(""), 1, 8), std::invalid_argument);
  EXPECT_THROW(Quantiser(1e20, 1e20 + 1e5, 16), std::invalid_argument);  // steps too fine for a double
  EXPECT_THROW(Quantiser(0, 1, 0), std::invalid_argument);
  EXPECT_THROW(Quantiser(0, 1, 17), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
