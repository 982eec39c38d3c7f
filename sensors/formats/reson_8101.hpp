// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sensors/formats/packet_bytes.hpp"

namespace tubefoot {

/// Settings that a RESON SeaBat 8101 reports with every ping. The defaults are the sonar's own if they are
/// known (240 kHz, 101 beams of 1.5 degrees), and 0 otherwise.
struct Reson8101Settings {
  double sound_speed_m_s = 1500;
  double range_m = 0;       ///< range setting, stored in whole metres; above 0
  double ping_rate_hz = 0;  ///< 0 to 65.535
  double pulse_s = 75e-6;   ///< stored in whole microseconds
  double frequency_khz = 240;
  int power = 0;  ///< 0 to 8
  int gain = 1;   ///< 1 to 45
  bool time_varied_gain = false;
  double spreading = 30;  ///< of the time-varied gain, 0 to 63.75
  double absorption_db_per_km = 0;
  double along_track_width_deg = 1.5, across_track_width_deg = 1.5;
  double beam_spacing_deg = 1.5;  ///< stored in tenths
  double projector_angle_deg = 0;
  double head_temperature_c = 0;
  std::uint32_t sonar_id = 0;
  /// The code of the 8101 is not established.
  std::uint16_t sonar_model = 8101;
  /// Rate at which ranges are counted, in quarters of a sample. Unset: the highest rate for the range
  /// setting, so that a count is as fine as the 16 bits allow.
  std::optional<double> sample_rate_hz{};
  /// The qualities of an odd number of beams end with half a byte. The sonar's documentation is said to add
  /// a byte to make their length even, but the one known reader (MB-System) does not expect it. If the two
  /// disagree, intensities are off by one byte.
  bool even_quality_length = false;
};

/// Rate at which ranges are counted: the rate in the settings, or the highest possible one.
double sample_rate_hz(const Reson8101Settings& settings);

/// Gain and its variation, in the encoding of the sonar's own packets and of others.
std::uint16_t gain_word(const Reson8101Settings& settings, const FieldCheck& check);

/// Quality bits of a beam; brightness and colinearity together mark a good sounding.
enum Reson8101Quality : std::uint8_t {
  kBrightness = 1,
  kColinearity = 2,
  kAmplitudeDetection = 4,
  kPhaseDetection = 8,
};

struct Reson8101Beam {
  double two_way_time_s = 0;  ///< 0: no bottom found
  std::uint8_t quality = 0;   ///< of Reson8101Quality
  std::uint16_t intensity = 0;
};

/// Encodes the "range, intensity, theta" packet (type 0x18) of an 8101 for a ping, big-endian, as in XTF
/// files. Beams are in order from port to starboard. Throws std::invalid_argument, with a message that
/// begins with `where`, for values out of range of their fields.
std::vector<unsigned char> reson_8101_packet(const Reson8101Settings& settings, double unix_time_s,
                                             std::uint32_t ping_number,
                                             const std::vector<Reson8101Beam>& beams,
                                             const std::string& where);

}  // namespace tubefoot
