// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/pictures/camera_fan.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

// The fan of a whole turn with steps of 0.9 degrees begins at -180.45 degrees: no sector behind is missing.
TEST(CameraFan, OfAWholeTurnShowsWhatIsStraightBehind) {
  std::vector<double> azimuths;
  for (int step = 0; step < 400; ++step) azimuths.push_back((-180 + 0.9 * step) * degree);
  const RangeSamples samples{0, 0.1, 100};
  const CameraFan fan(azimuths, samples, 2000, 2000);
  const double pixels = 9.95 * fan.pixels_per_m();
  for (const auto& [azimuth_deg, beam] :
       {std::pair(179.5, 399), {179.6, 0}, {180.0, 0}, {-179.6, 0}, {-179.5, 1}, {0.0, 200}, {0.44, 200}}) {
    const std::int64_t cell =
        fan.cell_at(fan.x(azimuth_deg * degree, pixels), fan.y(azimuth_deg * degree, pixels));
    ASSERT_GE(cell, 0) << azimuth_deg;
    EXPECT_EQ(cell / samples.count, beam) << azimuth_deg;
    EXPECT_EQ(cell % samples.count, 99) << azimuth_deg;
  }
}

TEST(CameraFan, OfASectorShowsNothingBeside) {
  const CameraFan fan({-10 * degree, 0, 10 * degree}, RangeSamples{0, 0.1, 100}, 500, 500);
  const double pixels = 5 * fan.pixels_per_m();
  for (const double azimuth_deg : {-16.0, 16.0, 180.0, -90.0})
    EXPECT_EQ(fan.cell_at(fan.x(azimuth_deg * degree, pixels), fan.y(azimuth_deg * degree, pixels)), -1)
        << azimuth_deg;
}

}  // namespace
}  // namespace tubefoot
