// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sensors/formats/byte_record.hpp"

// What DIDSON and ARIS files have in common (docs/files-ddf.md).
namespace tubefoot {

/// Which way a body points [deg]: heading clockwise from north, pitch bow up positive, roll starboard down
/// positive.
struct CameraAttitude {
  double heading_deg = 0, pitch_deg = 0, roll_deg = 0;
};

/// One picture of an acoustic camera, as it goes into a DIDSON or ARIS file.
struct CameraFrame {
  double unix_time_s = 0;                      ///< UTC, 1970 to 2106 (32 bits of seconds)
  double latitude_deg = 0, longitude_deg = 0;  ///< north and east positive
  CameraAttitude platform;                     ///< of what carries the camera
  std::optional<CameraAttitude> camera{};      ///< of the camera itself; absent: as the platform
  double velocity_m_s = 0;                     ///< of the platform, forward
  double depth_m = 0, altitude_m = 0;          ///< of the platform: below the surface, above the bottom
  std::span<const std::uint8_t> amplitudes;    ///< [beam][sample], port-most beam and nearest sample first
};

/// Throws std::invalid_argument, beginning with `what`, for a time, pose or number that is not finite or
/// outside of its range, and unless there are beams * samples amplitudes.
void check(const CameraFrame& frame, const std::string& what, int beams, int samples);

/// Puts velocity, depth, altitude, both attitudes and the position where all versions have them in the frame
/// header (bytes 124 to 187). Headings become 0 to 360 degrees, 360 excluded.
void put_platform(ByteRecord& header, const CameraFrame& frame);

/// A time as the headers have it, all parts of the same instant: rounded to hundredths of a second first.
struct CalendarTime {
  std::uint32_t year = 1970, month = 1, day = 1, hour = 0, minute = 0, second = 0, hundredth = 0;
  std::uint64_t unix_s = 0;
};
CalendarTime calendar_time(double unix_time_s);
/// yyyy-mm-dd_HHMMSS
std::string date_text(const CalendarTime& time);

/// From [beam][sample], port-most beam first, to [sample][beam], starboard-most beam first: the order in the
/// files of a camera that is not mounted upside down.
void reorder(std::span<const std::uint8_t> port_first, int beams, int samples,
             std::vector<std::uint8_t>& starboard_first);

/// A level as the files keep it: 0 to full_scale_db [dB] is 0 to 255, rounded to nearest, halves up, and
/// clamped; no energy at all (minus infinity) is 0. Throws std::invalid_argument if the level is not a
/// number.
std::uint8_t amplitude(double level_db, double full_scale_db);

/// Throws std::invalid_argument "<what>: <quantity> is <value>, must be <wanted>" unless `holds`.
void require_field(bool holds, const std::string& what, const char* quantity, double value,
                   const char* wanted);

}  // namespace tubefoot
