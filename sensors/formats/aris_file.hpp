// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

#include "scene/description/sensor_description.hpp"
#include "sensors/formats/camera_file.hpp"

// ARIS files (.aris, "DDF_05"): range gates in metres, and any number of samples. See
// docs/exchange-formats.md.
namespace tubefoot {

/// The values are those of the format.
enum class ArisModel : std::uint32_t { aris_1800 = 0, aris_3000 = 1, aris_1200 = 2 };
enum class ArisSalinity : std::uint32_t { fresh = 0, brackish = 15, salt = 35 };

/// The beam formation of an ARIS.
struct ArisPingMode {
  std::uint32_t code;  ///< code by which readers determine the number of beams
  int pings;           ///< transmissions per frame
  ArisModel model;     ///< model with this number of beams (48 beams: also the 1200)
};

/// Throws std::invalid_argument unless there are 48, 64, 96 or 128 beams.
ArisPingMode aris_ping_mode(int beams);

/// Range gate of an ARIS, in whole microseconds of two-way travel time.
struct ArisWindow {
  std::uint32_t start_delay_us = 930;  ///< transmission to first sample: 930 to 65535
  std::uint32_t sample_period_us = 4;  ///< 4 to 100

  double start_m(double sound_speed_m_s) const;
  double length_m(double sound_speed_m_s, int samples) const;
};

/// The range gate from start_m on with length length_m, both to within half a range sample. Throws
/// std::invalid_argument that lists the nearest range gates.
ArisWindow aris_window(double start_m, double length_m, int samples, double sound_speed_m_s);

/// The nearest range gate that an ARIS has: whole microseconds between samples and to the first sample,
/// which is not before its shortest delay. Empty if no ARIS gate is similar: samples longer or shorter than
/// those of an ARIS, or a later first sample.
std::optional<ArisWindow> nearest_aris_window(double start_m, double length_m, int samples,
                                              double sound_speed_m_s);

/// True for a sensor of an ARIS preset.
bool is_aris(const SensorDescription& sensor);

/// Throws std::invalid_argument that begins with `what` for a header that an ARIS file cannot represent.
struct ArisHeader;
void check(const ArisHeader& header, const std::string& what);

/// Data that all frames of an ARIS file share.
struct ArisHeader {
  std::string title{};
  std::optional<ArisModel> model{};  ///< unset: the model with this number of beams
  bool high_frequency = true;
  int beams = 96;  ///< 48, 64, 96 or 128
  int samples = 512;
  ArisWindow window{};
  double sound_speed_m_s = 1500;
  double frame_rate_hz = 1;
  std::uint32_t pulse_width_us = 0;  ///< 4 to 100; 0: unknown
  bool telephoto_lens = false;
  double water_temperature_c = 0;
  ArisSalinity salinity = ArisSalinity::salt;
  std::uint32_t serial_number = 100;
  std::uint32_t most_frames = std::numeric_limits<std::uint32_t>::max();  ///< further frames are rejected
};

/// Code of a level: 0 to 80 dB becomes 0 to 255 (see `amplitude`).
inline constexpr double aris_full_scale_db = 80;
std::uint8_t aris_amplitude(double level_db);

class ArisFile final : public CameraFile {
 public:
  ArisFile(const std::filesystem::path& file, ArisHeader header);

 private:
  PacketBytes file_header() const override;
  PacketBytes frame_header(const CameraFrame& frame) const override;

  ArisHeader header_;
};

}  // namespace tubefoot
