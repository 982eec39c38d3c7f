// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

#include "sensors/formats/camera_file.hpp"

// DIDSON files, version 3 (.ddf, "DDF_03"): docs/files-ddf.md.
namespace tubefoot {

/// Range window of a DIDSON: the file has codes, not metres.
struct DdfWindow {
  std::uint32_t start_code = 1;   ///< 1 to 31, times ddf_start_step_m
  std::uint32_t length_code = 2;  ///< 0 to 3, see ddf_window_length_m
};

/// What is the same for all frames of a DIDSON file.
struct DdfHeader {
  std::string title{};
  bool high_resolution = true;  ///< "identification" (1.8 MHz), else "detection" (1.1 MHz)
  /// 96 in high resolution, 48 in low resolution and always of a long-range camera.
  int beams = 96;
  int samples = 512;  ///< of a beam; the format has no other
  DdfWindow window{};
  double frame_rate_hz = 1;  ///< nominal; the file has whole numbers, at least 1
  /// Down-range sampling [Hz]: ddf_sample_rate_hz of the window's length.
  double sample_rate_hz = 0;
  double sound_speed_m_s = 1500;
  double water_temperature_c = 0;
  /// Below 19, readers take the camera for an early one with other windows.
  std::uint32_t serial_number = 100;
  /// Bit 0: classic windows. Bit 1: long-range camera. Of the higher bits (their meaning is not public)
  /// readers need at least one.
  std::uint32_t config_flags = 4;
  /// More frames are refused. 65535 suits readers that see 16 bits of the count.
  std::uint32_t most_frames = std::numeric_limits<std::uint32_t>::max();
};

/// Length [m] that the flags' window table has for a code 0 to 3.
double ddf_window_length_m(const DdfHeader& camera, std::uint32_t length_code);

/// How readers turn a start code into metres; they disagree by 2 % (early cameras: 9 %), except on
/// classic windows.
enum class DdfStartStep {
  vendor,     ///< 0.42 m (low resolution 0.84 m), of the vendor's document
  matlab,     ///< 0.419 m (0.838 m), of the MATLAB reader and its descendants
  delay_time  ///< 0.572 ms (1.144 ms) of sound, there and back; 0.512 ms (1.024 ms) up to serial number 18
};

/// Metres of a start code of 1.
double ddf_start_step_m(const DdfHeader& camera, DdfStartStep step = DdfStartStep::vendor);

/// Codes of the window that begins at start_m and is length_m long, each within half a range sample. Looks at
/// the camera's resolution, flags, serial number and sound speed. Throws std::invalid_argument that says
/// which windows there are; also for the two lengths that readers disagree on (1.25 m, and 80 m long-range).
DdfWindow ddf_window(const DdfHeader& camera, double start_m, double length_m,
                     DdfStartStep step = DdfStartStep::vendor);

/// The sample rate [Hz] from which readers that have no table of lengths find this length: 512 samples over
/// it. They take sound to travel at 1500 m/s.
double ddf_sample_rate_hz(double length_m, double sound_speed_m_s = 1500);

/// A level as the file keeps it: 0 to 90 dB is 0 to 255 (see `amplitude`).
inline constexpr double ddf_full_scale_db = 90;
std::uint8_t ddf_amplitude(double level_db);

/// Throws std::invalid_argument, beginning with `what`, for what no DIDSON file has.
void check(const DdfHeader& header, const std::string& what);

class DdfFile final : public CameraFile {
 public:
  DdfFile(const std::filesystem::path& file, DdfHeader header);

 private:
  ByteRecord file_header() const override;
  ByteRecord frame_header(const CameraFrame& frame) const override;

  DdfHeader header_;
};

}  // namespace tubefoot
