// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

#include "sensors/formats/camera_file.hpp"

// DIDSON files, version 3 (.ddf, "DDF_03"): docs/exchange-formats.md.
namespace tubefoot {

/// Range gate of a DIDSON as codes; the file contains no metres.
struct DdfWindow {
  std::uint32_t start_code = 1;   ///< 1 to 31, times ddf_start_step_m
  std::uint32_t length_code = 2;  ///< 0 to 3, see ddf_window_length_m
};

/// Data that all frames of a DIDSON file share.
struct DdfHeader {
  std::string title{};
  bool high_resolution = true;  ///< "identification" (1.8 MHz), otherwise "detection" (1.1 MHz)
  /// 96 in high resolution; 48 in low resolution and for a long-range camera.
  int beams = 96;
  int samples = 512;  ///< per beam; the format has no other number
  DdfWindow window{};
  double frame_rate_hz = 1;  ///< nominal; the file has whole numbers, at least 1
  /// Down-range sampling [Hz]: ddf_sample_rate_hz of the length of the range gate.
  double sample_rate_hz = 0;
  double sound_speed_m_s = 1500;
  double water_temperature_c = 0;
  /// Readers take numbers below 19 for an early camera with other range gates.
  std::uint32_t serial_number = 100;
  /// Bit 0: classic range gates. Bit 1: long-range camera. Readers require at least one of the higher bits,
  /// whose meaning is not public.
  std::uint32_t config_flags = 4;
  /// Further frames are rejected. 65535 suits readers that use 16 bits of the count.
  std::uint32_t most_frames = std::numeric_limits<std::uint32_t>::max();
};

/// Length [m] of a code 0 to 3 in the table of range gates that the flags select.
double ddf_window_length_m(const DdfHeader& camera, std::uint32_t length_code);

/// Conversion of a start code to metres. Readers disagree by 2 % (early cameras: 9 %), except for classic
/// range gates.
enum class DdfStartStep {
  vendor,     ///< 0.42 m (low resolution 0.84 m), from the vendor's document
  matlab,     ///< 0.419 m (0.838 m), from the MATLAB reader and its descendants
  delay_time  ///< 0.572 ms (1.144 ms) of two-way travel time; 0.512 ms (1.024 ms) up to serial number 18
};

/// Metres of a start code of 1.
double ddf_start_step_m(const DdfHeader& camera, DdfStartStep step = DdfStartStep::vendor);

/// Codes of the range gate from start_m on with length length_m, each to within half a range sample. They
/// depend on the camera's resolution, flags, serial number and sound speed. Throws std::invalid_argument
/// that lists the possible range gates. Throws it also for the two lengths on which readers disagree (1.25
/// m, and 80 m long-range).
DdfWindow ddf_window(const DdfHeader& camera, double start_m, double length_m,
                     DdfStartStep step = DdfStartStep::vendor);

/// Sample rate [Hz] from which readers without a table of lengths compute this length: 512 samples over it.
/// They assume a sound speed of 1500 m/s.
double ddf_sample_rate_hz(double length_m, double sound_speed_m_s = 1500);

/// Code of a level: 0 to 90 dB becomes 0 to 255 (see `amplitude`).
inline constexpr double ddf_full_scale_db = 90;
std::uint8_t ddf_amplitude(double level_db);

/// Throws std::invalid_argument that begins with `what` for a header that a DIDSON file cannot represent.
void check(const DdfHeader& header, const std::string& what);

class DdfFile final : public CameraFile {
 public:
  DdfFile(const std::filesystem::path& file, DdfHeader header);

 private:
  PacketBytes file_header() const override;
  PacketBytes frame_header(const CameraFrame& frame) const override;

  DdfHeader header_;
};

}  // namespace tubefoot
