// SPDX-License-Identifier: GPL-3.0-or-later
// Common parts of DIDSON and ARIS frames: checks, the platform's fields in the frame header, calendar times,
// sample order and amplitude codes. See docs/exchange-formats.md.

#include "sensors/formats/camera_frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace tubefoot {

namespace {

void check(const CameraAttitude& attitude, const std::string& what) {
  // The heading is reduced by whole turns. Above this limit a double does not resolve degrees.
  require_field(std::abs(attitude.heading_deg) <= 1e9, what, "the heading", attitude.heading_deg,
                "a finite number of degrees");
  require_field(std::abs(attitude.pitch_deg) <= 90, what, "the pitch", attitude.pitch_deg,
                "-90 to 90 degrees");
  require_field(std::abs(attitude.roll_deg) <= 180, what, "the roll", attitude.roll_deg,
                "-180 to 180 degrees");
}

double heading_in_circle(double heading_deg) {
  double heading = std::fmod(heading_deg, 360);
  if (heading < 0) heading += 360;
  // Single precision rounds values just below 360 to 360.
  return static_cast<float>(heading) >= 360 ? 0 : heading;
}

}  // namespace

void require_field(bool holds, const std::string& what, const char* quantity, double value,
                   const char* wanted) {
  if (!holds)
    throw std::invalid_argument(fmt::format("{}: {} is {}, but must be {}", what, quantity, value, wanted));
}

void check(const CameraFrame& frame, const std::string& what, int beams, int samples) {
  require_field(frame.unix_time_s >= 0 && frame.unix_time_s <= std::numeric_limits<std::uint32_t>::max(),
                what, "the time", frame.unix_time_s, "a time before 2106 in seconds since 1970");
  require_field(std::abs(frame.latitude_deg) <= 90, what, "the latitude", frame.latitude_deg,
                "-90 to 90 degrees");
  require_field(std::abs(frame.longitude_deg) <= 180, what, "the longitude", frame.longitude_deg,
                "-180 to 180 degrees");
  check(frame.platform, what);
  if (frame.camera) check(*frame.camera, what);
  constexpr double far = 1e6;  // limit for metres and for metres per second: no water is as deep
  require_field(std::abs(frame.velocity_m_s) <= far, what, "the velocity", frame.velocity_m_s,
                "between -1e6 and 1e6 m/s");
  require_field(std::abs(frame.depth_m) <= far, what, "the depth", frame.depth_m, "between -1e6 and 1e6 m");
  require_field(std::abs(frame.altitude_m) <= far, what, "the altitude", frame.altitude_m,
                "between -1e6 and 1e6 m");
  const std::size_t wanted = static_cast<std::size_t>(beams) * static_cast<std::size_t>(samples);
  if (frame.amplitudes.size() != wanted)
    throw std::invalid_argument(
        fmt::format("{}: there are {} amplitudes instead of {} for {} beams of {} samples", what,
                    frame.amplitudes.size(), wanted, beams, samples));
}

void put_platform(PacketBytes& header, const CameraFrame& frame) {
  header.put_single(124, frame.velocity_m_s);
  header.put_single(128, frame.depth_m);
  header.put_single(132, frame.altitude_m);
  // The rates between these fields (140, 148, 156) stay 0.
  header.put_single(136, frame.platform.pitch_deg);
  header.put_single(144, frame.platform.roll_deg);
  header.put_single(152, heading_in_circle(frame.platform.heading_deg));
  const CameraAttitude camera = frame.camera.value_or(frame.platform);
  header.put_single(160, heading_in_circle(camera.heading_deg));
  header.put_single(164, camera.pitch_deg);
  header.put_single(168, camera.roll_deg);
  header.put<double>(172, frame.latitude_deg);
  header.put<double>(180, frame.longitude_deg);
}

CalendarTime calendar_time(double unix_time_s) {
  using namespace std::chrono;
  const auto hundredths = static_cast<std::uint64_t>(std::llround(unix_time_s * 100));
  CalendarTime time;
  time.unix_s = hundredths / 100;
  time.hundredth = static_cast<std::uint32_t>(hundredths % 100);
  const sys_seconds instant{seconds{time.unix_s}};
  const auto midnight = floor<days>(instant);
  const year_month_day date{midnight};
  const hh_mm_ss clock{instant - midnight};
  time.year = static_cast<std::uint32_t>(static_cast<int>(date.year()));
  time.month = static_cast<unsigned>(date.month());
  time.day = static_cast<unsigned>(date.day());
  time.hour = static_cast<std::uint32_t>(clock.hours().count());
  time.minute = static_cast<std::uint32_t>(clock.minutes().count());
  time.second = static_cast<std::uint32_t>(clock.seconds().count());
  return time;
}

std::string date_text(const CalendarTime& time) {
  return fmt::format("{:04}-{:02}-{:02}_{:02}{:02}{:02}", time.year, time.month, time.day, time.hour,
                     time.minute, time.second);
}

void reorder(std::span<const std::uint8_t> port_first, int beams, int samples,
             std::vector<std::uint8_t>& starboard_first) {
  const auto columns = static_cast<std::size_t>(beams), rows = static_cast<std::size_t>(samples);
  starboard_first.resize(columns * rows);
  for (std::size_t beam = 0; beam < columns; ++beam)
    for (std::size_t sample = 0; sample < rows; ++sample)
      starboard_first[sample * columns + (columns - 1 - beam)] = port_first[beam * rows + sample];
}

std::uint8_t amplitude(double level_db, double full_scale_db) {
  if (std::isnan(level_db)) throw std::invalid_argument("a level in dB is not a number");
  return static_cast<std::uint8_t>(std::round(std::clamp(level_db * 255 / full_scale_db, 0.0, 255.0)));
}

}  // namespace tubefoot
