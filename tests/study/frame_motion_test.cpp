// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/frame_motion.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace tubefoot {
namespace {

constexpr double unseen = std::numeric_limits<double>::quiet_NaN();

/// A smooth random scene that is defined at all positions.
class Scenery {
 public:
  explicit Scenery(unsigned seed) : random_(seed) {
    std::uniform_real_distribution<double> wave(0.4, 1.2), phase(0, 6.283), turn(0, 6.283);
    for (auto& w : waves_) {
      const double k = wave(random_), a = turn(random_);
      w = {k * std::cos(a), k * std::sin(a), phase(random_)};
    }
  }
  double at(double x, double y) const {
    double sum = 0;
    for (const auto& [kx, ky, phase] : waves_) sum += std::sin(kx * x + ky * y + phase);
    return sum;
  }
  /// The view with the corner of the window at (x, y). A triangle of the view is hidden.
  PixelMap view(double x, double y, double noise = 0) {
    PixelMap map{80, 60, {}};
    std::normal_distribution<double> gauss(0, 1);
    for (std::size_t r = 0; r < map.rows; ++r)
      for (std::size_t c = 0; c < map.columns; ++c)
        map.values.push_back(c + r < 20 ? unseen
                                        : at(x + static_cast<double>(c), y + static_cast<double>(r)) +
                                              noise * gauss(random_));
    return map;
  }

 private:
  std::mt19937 random_;
  std::array<std::array<double, 3>, 40> waves_;
};

TEST(FrameMotion, FindsWholeAndBrokenShifts) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Scenery scenery(seed);
    const PixelMap first = scenery.view(0, 0);
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {3.0, -2.0}, {-7.0, 5.0}, {2.4, 1.7}, {-0.5, -3.3}}) {
      // The contents move opposite to the window.
      const FrameShift shift = find_shift(first, scenery.view(x, y), 10);
      EXPECT_NEAR(shift.columns, -x, 0.15) << "seed " << seed;
      EXPECT_NEAR(shift.rows, -y, 0.15) << "seed " << seed;
      EXPECT_GT(shift.correlation, 0.9) << "seed " << seed;
    }
  }
}

TEST(FrameMotion, ReadsThroughNoiseAndBrightness) {
  Scenery scenery(11);
  const PixelMap first = scenery.view(0, 0, 2);
  PixelMap second = scenery.view(4, -3, 2);
  for (double& v : second.values) v = 5 * v - 3;
  const FrameShift shift = find_shift(first, second, 10);
  EXPECT_NEAR(shift.columns, -4, 0.5);
  EXPECT_NEAR(shift.rows, 3, 0.5);
  EXPECT_NEAR(shift.correlation, 20 / 24.0, 0.1) << "variance of the scene over that of the frames";
}

TEST(FrameMotion, NoiseAloneHasNoPeak) {
  std::mt19937 random(3);
  std::exponential_distribution<double> speckle(1);
  for (int trial = 0; trial < 20; ++trial) {
    PixelMap first{80, 60, {}}, second{80, 60, {}};
    for (int k = 0; k < 4800; ++k) {
      first.values.push_back(speckle(random));
      second.values.push_back(speckle(random));
    }
    const FrameShift shift = find_shift(first, second, 12);
    EXPECT_LT(shift.correlation, 0.1) << trial;
  }
}

TEST(FrameMotion, RefusesWhatHasNoAnswer) {
  const PixelMap frame{4, 3, std::vector<double>(12, 1.0)}, other{3, 4, std::vector<double>(12, 1.0)},
      dark{4, 3, std::vector<double>(12, unseen)};
  EXPECT_THROW(find_shift(frame, other, 1), std::invalid_argument);
  EXPECT_THROW(find_shift(frame, dark, 1), std::invalid_argument);
  EXPECT_THROW(find_shift(frame, frame, 0), std::invalid_argument);
  EXPECT_THROW(find_shift(frame, frame, 3), std::invalid_argument);
  EXPECT_EQ(find_shift(frame, frame, 2).correlation, 0) << "an even picture is like no other";
}

}  // namespace
}  // namespace tubefoot
