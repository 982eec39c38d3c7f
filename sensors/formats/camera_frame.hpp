// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sensors/formats/packet_bytes.hpp"

// Common parts of DIDSON and ARIS files (docs/exchange-formats.md).
namespace tubefoot {

/// Attitude of a body [deg]: heading clockwise from north, pitch bow up positive, roll starboard down
/// positive.
struct CameraAttitude {
  double heading_deg = 0, pitch_deg = 0, roll_deg = 0;
};

/// One frame of an acoustic camera in a DIDSON or ARIS file.
struct CameraFrame {
  double unix_time_s = 0;                      ///< UTC, 1970 to 2106 (32 bits of seconds)
  double latitude_deg = 0, longitude_deg = 0;  ///< north and east positive
  CameraAttitude platform;                     ///< of the camera's carrier
  std::optional<CameraAttitude> camera{};      ///< of the camera itself; unset: as the platform
  double velocity_m_s = 0;                     ///< of the platform, forward
  double depth_m = 0, altitude_m = 0;          ///< of the platform: below the surface, above the bottom
  std::span<const std::uint8_t> amplitudes;    ///< [beam][sample], port-most beam and nearest sample first
};

/// Throws std::invalid_argument that begins with `what` for a time, pose or number that is not finite or out
/// of its range. Throws it also unless there are beams * samples amplitudes.
void check(const CameraFrame& frame, const std::string& what, int beams, int samples);

/// Writes velocity, depth, altitude, both attitudes and the position at the bytes 124 to 187 of the frame
/// header, which all versions share. Headings become 0 to 360 degrees, without 360.
void put_platform(PacketBytes& header, const CameraFrame& frame);

/// A time in the form of the headers. All parts are of the same instant, rounded to hundredths of a second.
struct CalendarTime {
  std::uint32_t year = 1970, month = 1, day = 1, hour = 0, minute = 0, second = 0, hundredth = 0;
  std::uint64_t unix_s = 0;
};
CalendarTime calendar_time(double unix_time_s);
/// yyyy-mm-dd_HHMMSS
std::string date_text(const CalendarTime& time);

/// Converts [beam][sample], port-most beam first, to [sample][beam], starboard-most beam first. The latter
/// is the order in the files of a camera that is not mounted upside down.
void reorder(std::span<const std::uint8_t> port_first, int beams, int samples,
             std::vector<std::uint8_t>& starboard_first);

/// Code of a level in the files: 0 to full_scale_db [dB] becomes 0 to 255, rounded to nearest, halves up,
/// and clamped. No energy (minus infinity) becomes 0. Throws std::invalid_argument for NaN.
std::uint8_t amplitude(double level_db, double full_scale_db);

/// Throws std::invalid_argument "<what>: <quantity> is <value>, must be <wanted>" unless `holds`.
void require_field(bool holds, const std::string& what, const char* quantity, double value,
                   const char* wanted);

}  // namespace tubefoot
