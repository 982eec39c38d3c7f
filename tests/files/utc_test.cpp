// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/utc.hpp"

#include <gtest/gtest.h>

namespace tubefoot {
namespace {

TEST(Utc, KnownTimes) {
  EXPECT_EQ(unix_time_s("1970-01-01T00:00:00Z"), 0.0);
  EXPECT_EQ(unix_time_s("2000-01-01T00:00:00Z"), 946684800.0);
  EXPECT_EQ(unix_time_s("2009-02-13T23:31:30Z"), 1234567890.0);
  EXPECT_EQ(unix_time_s("2024-02-29T12:00:00.25Z"), 1709208000.25);
}

TEST(Utc, RefusesWhatIsNoTime) {
  for (const char* text :
       {"", "today", "2026-07-01", "2026-07-01T12:00:00", "2026-07-01 12:00:00Z", "2025-02-29T00:00:00Z",
        "2026-13-01T00:00:00Z", "2026-01-01T24:00:00Z", "2026-01-01T00:60:00Z", "2026-01-01T00:00:60Z",
        "1969-12-31T23:59:59Z", "2100-01-01T00:00:00Z", "2026-01-01T00:00:00ZZ", "+026-01-01T00:00:00Z"})
    EXPECT_FALSE(unix_time_s(text).has_value()) << text;
}

}  // namespace
}  // namespace tubefoot
