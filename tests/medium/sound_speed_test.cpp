// SPDX-License-Identifier: GPL-3.0-or-later
#include "medium/sound_speed.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace tubefoot
