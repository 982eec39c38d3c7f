// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

#include "sensors/formats/packet_bytes.hpp"

namespace tubefoot {

/// A time in the various fields of packets: UTC, without leap seconds.
struct PacketMoment {
  std::uint32_t epoch_s = 0, microseconds = 0;
  std::int64_t since_1970_ms = 0;
  std::uint16_t year = 0, day_of_year = 0;
  std::uint8_t month = 0, day = 0, hour = 0, minute = 0, second = 0;
};

/// Converts a time from 1970 to 2106, rounded to whole microseconds.
inline PacketMoment moment(double unix_time_s, const FieldCheck& check) {
  constexpr double end_s = 4294967295;  // the epoch fields are 32 bits wide
  check.within("time [s since 1970]", unix_time_s, 0, end_s);
  using namespace std::chrono;
  const auto since_1970 = microseconds(std::llround(unix_time_s * 1e6));
  const sys_time<microseconds> time(since_1970);
  const auto midnight = floor<days>(time);
  const year_month_day date(midnight);
  const hh_mm_ss clock(time - midnight);

  PacketMoment result;
  result.epoch_s = static_cast<std::uint32_t>(floor<seconds>(since_1970).count());
  result.microseconds = static_cast<std::uint32_t>(clock.subseconds().count());
  result.since_1970_ms = floor<milliseconds>(since_1970).count();
  result.year = static_cast<std::uint16_t>(int(date.year()));
  result.month = static_cast<std::uint8_t>(unsigned(date.month()));
  result.day = static_cast<std::uint8_t>(unsigned(date.day()));
  result.day_of_year =
      static_cast<std::uint16_t>((midnight - sys_days(date.year() / January / 1)).count() + 1);
  result.hour = static_cast<std::uint8_t>(clock.hours().count());
  result.minute = static_cast<std::uint8_t>(clock.minutes().count());
  result.second = static_cast<std::uint8_t>(clock.seconds().count());
  return result;
}

}  // namespace tubefoot
