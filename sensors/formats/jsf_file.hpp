// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>

#include "files/streamed_file.hpp"

namespace tubefoot {

/// EdgeTech's subsystem numbers, by the signal of the sonar.
enum class JsfSubsystem : std::uint8_t { sidescan_low = 20, sidescan_high = 21, sidescan_very_high = 22 };

/// One side of one ping of a sidescan. Unknown values are NaN, and their validity bits are not set.
struct JsfPing {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();
  JsfSubsystem subsystem = JsfSubsystem::sidescan_low;
  bool starboard = false;
  std::uint32_t number = 0;
  double unix_time_s = 0;     ///< UTC, seconds since 1970 without leap seconds
  double x = none, y = none;  ///< longitude and latitude [deg], or easting and northing [m]
  bool degrees = true;        ///< unit of x and y: degrees, or metres
  double heading_deg = none;  ///< clockwise from north, 0 to 360
  double pitch_deg = none;    ///< bow up, -90 to 90
  double roll_deg = none;     ///< starboard down, -180 to 180
  double depth_m = none;      ///< of the sonar below the surface; 0 or more
  double altitude_m = none;   ///< of the sonar above the bottom; 0 or more
  double sound_speed_m_s = none;
  double start_hz = 0, stop_hz = 0;  ///< of the pulse
  double sweep_s = 0;                ///< its length
  double mixer_hz = 0;               ///< centre frequency of the samples' baseband
  double sample_interval_s = 0;      ///< between complex samples
  std::uint32_t first_sample = 0;    ///< number of samples from the transmission to the first sample of the
                                     ///< ping
  std::string annotation{};          ///< at most 23 bytes
};

/// An EdgeTech JSF file of sidescan messages (type 80) with complex, matched-filtered samples (data format
/// 1), protocol version 13 (docs/exchange-formats.md). A power of two, the message's weighting factor N,
/// scales the samples to use the 16 bits of each part: value = integer x 2^-N.
class JsfFile {
 public:
  explicit JsfFile(const std::filesystem::path& file) : file_(file) {}

  /// Adds one side of a ping, with at least one sample and less than 2^20. Throws std::invalid_argument that
  /// names the ping for a value out of range of its field. Throws std::runtime_error if the disk is full.
  void add(const JsfPing& ping, std::span<const std::complex<double>> samples);
  /// Completes the file. Afterwards the system has accepted all bytes.
  void finish() { file_.close(); }

 private:
  StreamedFile file_;
};

}  // namespace tubefoot
