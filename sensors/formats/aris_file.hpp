// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

#include "scene/description/scene_description.hpp"
#include "sensors/formats/camera_file.hpp"

// ARIS files (.aris, "DDF_05"): windows in metres and any number of samples. docs/files-ddf.md.
namespace tubefoot {

/// The numbers are the format's.
enum class ArisModel : std::uint32_t { aris_1800 = 0, aris_3000 = 1, aris_1200 = 2 };
enum class ArisSalinity : std::uint32_t { fresh = 0, brackish = 15, salt = 35 };

/// How an ARIS forms its beams.
struct ArisPingMode {
  std::uint32_t code;  ///< as readers tell the number of beams
  int pings;           ///< transmissions of a frame
  ArisModel model;     ///< that has so many beams (48: the 1200 has, too)
};

/// Throws std::invalid_argument unless there are 48, 64, 96 or 128 beams.
ArisPingMode aris_ping_mode(int beams);

/// Range window of an ARIS, in whole microseconds of two-way travel.
struct ArisWindow {
  std::uint32_t start_delay_us = 930;  ///< transmission to first sample: 930 to 65535
  std::uint32_t sample_period_us = 4;  ///< 4 to 100

  double start_m(double sound_speed_m_s) const;
  double length_m(double sound_speed_m_s, int samples) const;
};

/// The window that begins at start_m and is length_m long, both within half a range sample. Throws
/// std::invalid_argument that says which windows are near.
ArisWindow aris_window(double start_m, double length_m, int samples, double sound_speed_m_s);

/// The nearest window that an ARIS has: whole microseconds from sample to sample, and to the first one, no
/// earlier than it listens. None where that is another window altogether: samples longer or shorter than an
/// ARIS's, or a first one later.
std::optional<ArisWindow> nearest_aris_window(double start_m, double length_m, int samples,
                                              double sound_speed_m_s);

/// Whether a sensor is of one of the ARIS presets.
bool is_aris(const SensorDescription& sensor);

/// Throws std::invalid_argument, beginning with `what`, for what no ARIS file has.
struct ArisHeader;
void check(const ArisHeader& header, const std::string& what);

/// What is the same for all frames of an ARIS file.
struct ArisHeader {
  std::string title{};
  std::optional<ArisModel> model{};  ///< absent: the model with so many beams
  bool high_frequency = true;
  int beams = 96;  ///< 48, 64, 96 or 128
  int samples = 512;
  ArisWindow window{};
  double sound_speed_m_s = 1500;
  double frame_rate_hz = 1;
  std::uint32_t pulse_width_us = 0;  ///< 4 to 100; 0: not known
  bool telephoto_lens = false;
  double water_temperature_c = 0;
  ArisSalinity salinity = ArisSalinity::salt;
  std::uint32_t serial_number = 100;
  std::uint32_t most_frames = std::numeric_limits<std::uint32_t>::max();  ///< more are refused
};

/// A level as the file keeps it: 0 to 80 dB is 0 to 255 (see `amplitude`).
inline constexpr double aris_full_scale_db = 80;
std::uint8_t aris_amplitude(double level_db);

class ArisFile final : public CameraFile {
 public:
  ArisFile(const std::filesystem::path& file, ArisHeader header);

 private:
  ByteRecord file_header() const override;
  ByteRecord frame_header(const CameraFrame& frame) const override;

  ArisHeader header_;
};

}  // namespace tubefoot
