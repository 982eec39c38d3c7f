// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/water/sound_speed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tubefoot {
namespace {

TEST(MackenzieSoundSpeed, PublishedCheckValues) {
  EXPECT_NEAR(mackenzie_sound_speed_m_s(25, 35, 1000), 1550.744, 5e-4);
  EXPECT_NEAR(mackenzie_sound_speed_m_s(25, 35, 1000), 1550.744028, 1e-6);
  EXPECT_NEAR(mackenzie_sound_speed_m_s(25.8543, 34.6954, 0), 1535.9781, 1e-4);
  EXPECT_NEAR(mackenzie_sound_speed_m_s(4.3149, 34.5221, 1000), 1483.6464, 1e-4);
  EXPECT_NEAR(mackenzie_sound_speed_m_s(1.4465, 34.6968, 5000), 1540.6472, 1e-4);
  EXPECT_NEAR(mackenzie_sound_speed_m_s(0, 30, 10), 1442.42, 5e-3);
}

TEST(LeroySoundSpeed, PublishedCheckValues) {
  const struct {
    double latitude, salinity, temperature, depth, speed;
  } rows[] = {
      {35, 38.7, 13.6, 0, 1506.586},    {35, 38.7, 13.6, 500, 1514.746},  {35, 38.7, 13.6, 1000, 1523.018},
      {35, 38.7, 13.6, 2000, 1539.838}, {35, 38.7, 13.6, 5000, 1591.418}, {35, 38.7, 13.6, 5500, 1600.019},
      {9, 34.5, 10.3, 0, 1490.291},     {9, 34.5, 10.3, 1000, 1506.611},  {9, 34.5, 10.3, 3000, 1540.370},
      {9, 34.5, 10.3, 6000, 1592.272},  {20, 40.5, 21.5, 0, 1531.724},    {20, 40.5, 21.5, 1000, 1548.239},
      {20, 40.5, 21.5, 3500, 1590.667}, {80, 35, -1, 0, 1444.429},        {80, 35, -1, 1000, 1460.820},
      {80, 35, -1, 3000, 1494.981},     {80, 35, -1, 5500, 1539.872}};
  for (const auto& r : rows) {
    EXPECT_NEAR(leroy_sound_speed_m_s(r.temperature, r.salinity, r.depth, r.latitude), r.speed, 6e-4)
        << r.latitude << ' ' << r.depth;
  }
  EXPECT_EQ(leroy_sound_speed_m_s(5, 34, 3000, -40), leroy_sound_speed_m_s(5, 34, 3000, 40));
}

TEST(SoundSpeedFormulas, AgreeWhereBothHold) {
  double near = 0, wide = 0;
  for (double t = 0; t <= 30; t += 0.5) {
    for (double s = 30; s <= 40; s += 0.5) {
      for (double z = 0; z <= 2000; z += 50) {
        const double d = std::abs(mackenzie_sound_speed_m_s(t, s, z) - leroy_sound_speed_m_s(t, s, z, 45));
        wide = std::max(wide, d);
        if (t >= 2 && t <= 25 && s >= 33 && s <= 37 && z <= 300) near = std::max(near, d);
      }
    }
  }
  EXPECT_NEAR(near, 0.191, 2e-3);
  EXPECT_NEAR(wide, 0.775, 2e-3);
}

}  // namespace
}  // namespace tubefoot
