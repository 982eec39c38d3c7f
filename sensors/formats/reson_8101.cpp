// SPDX-License-Identifier: GPL-3.0-or-later
// Encodes the pings of a RESON SeaBat 8101 as its "range, intensity, theta" packets (type 0x18), big-endian.
// Ranges are counts of a quarter of a sample at the sample rate.

#include "sensors/formats/reson_8101.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sensors/formats/packet_bytes.hpp"

namespace tubefoot {
namespace {

constexpr std::uint8_t range_intensity_theta = 0x18;
constexpr std::size_t fixed_part = 68;  // bytes before the ranges
constexpr double counts_per_sample = 4;

void put_settings(PacketBytes& packet, const Reson8101Settings& settings, double sample_rate_hz,
                  const FieldCheck& check) {
  packet.put<std::uint32_t>(20, settings.sonar_id);
  packet.put<std::uint16_t>(24, settings.sonar_model);
  packet.put<std::uint16_t>(26, check.integer<std::uint16_t>("frequency [kHz]", settings.frequency_khz));
  packet.put<std::uint16_t>(28, check.integer<std::uint16_t>("sound speed [m/s]", settings.sound_speed_m_s));
  packet.put<std::uint16_t>(30, check.integer<std::uint16_t>("sample rate [Hz]", sample_rate_hz));
  packet.put<std::uint16_t>(32, check.integer<std::uint16_t>("ping rate [Hz]", settings.ping_rate_hz, 1e3));
  packet.put<std::uint16_t>(34, check.integer<std::uint16_t>("range setting [m]", settings.range_m));
  packet.put<std::uint16_t>(36, static_cast<std::uint16_t>(check.within("power", settings.power, 0, 8)));
  packet.put<std::uint16_t>(38, gain_word(settings, check));
  packet.put<std::uint16_t>(40, check.integer<std::uint16_t>("pulse [s]", settings.pulse_s, 1e6));
  packet.put<std::uint8_t>(42, check.integer<std::uint8_t>("spreading of the gain", settings.spreading, 4));
  packet.put<std::uint8_t>(43,
                           check.integer<std::uint8_t>("absorption [dB/km]", settings.absorption_db_per_km));
  packet.put<std::uint8_t>(
      45, check.integer<std::uint8_t>("along-track width [deg]", settings.along_track_width_deg, 10));
  packet.put<std::uint16_t>(
      46, check.integer<std::uint16_t>("beam spacing [deg]", settings.beam_spacing_deg, 10));
  packet.put<std::uint16_t>(48, 10);
  packet.put<std::int16_t>(
      50, check.integer<std::int16_t>("projector angle [deg]", settings.projector_angle_deg, 100));
  packet.put<std::int16_t>(
      64, check.integer<std::int16_t>("head temperature [C]", settings.head_temperature_c, 10));
}

}  // namespace

/// Sound returns within 2 range / c, and the count of that time must fit 16 bits. The field of the rate has
/// 16 bits as well.
double sample_rate_hz(const Reson8101Settings& settings) {
  constexpr double largest = std::numeric_limits<std::uint16_t>::max();
  const double finest = std::min(
      largest, std::floor(largest * settings.sound_speed_m_s / (counts_per_sample * 2 * settings.range_m)));
  return settings.sample_rate_hz.value_or(finest);
}

std::uint16_t gain_word(const Reson8101Settings& settings, const FieldCheck& check) {
  constexpr int time_varied = 1 << 14;
  const int gain = static_cast<int>(check.within("gain", settings.gain, 1, 45));
  return static_cast<std::uint16_t>(gain | (settings.time_varied_gain ? time_varied : 0));
}

std::vector<unsigned char> reson_8101_packet(const Reson8101Settings& settings, double unix_time_s,
                                             std::uint32_t ping_number,
                                             const std::vector<Reson8101Beam>& beams,
                                             const std::string& where) {
  const FieldCheck check(where);
  check.positive("sound speed [m/s]", settings.sound_speed_m_s);
  check.positive("range setting [m]", settings.range_m);
  if (beams.empty()) check.fail("there are no beams");
  const double sample_rate_hz = check.positive("sample rate [Hz]", tubefoot::sample_rate_hz(settings));
  constexpr double latest_s = std::numeric_limits<std::uint32_t>::max();
  const double time_us = std::round(check.within("time [s since 1970]", unix_time_s, 0, latest_s) * 1e6);
  const double time_ms = std::floor(time_us / 1e3);

  PacketBytes packet(std::endian::big, fixed_part);
  packet.put<std::uint16_t>(0, 0xFFFF);  // FF FF 00 00 begins the packet
  packet.put<std::uint8_t>(4, range_intensity_theta);
  packet.put<std::uint32_t>(8, static_cast<std::uint32_t>(time_ms / 1e3));
  packet.put<std::uint32_t>(12, static_cast<std::uint32_t>(std::fmod(time_ms, 1e3)));
  packet.put<std::uint32_t>(16, ping_number);
  put_settings(packet, settings, sample_rate_hz, check);
  packet.put<std::int16_t>(66,
                           check.integer<std::int16_t>("number of beams", static_cast<double>(beams.size())));

  for (const Reson8101Beam& beam : beams) {
    check.within("two-way time [s]", beam.two_way_time_s, 0, std::numeric_limits<double>::max());
    packet.append<std::uint16_t>(check.integer<std::uint16_t>("two-way time [s]", beam.two_way_time_s,
                                                              counts_per_sample * sample_rate_hz));
  }
  const std::size_t quality_begin = packet.size();
  packet.append_zeros((beams.size() + 1) / 2);
  if (settings.even_quality_length) packet.append_zeros((packet.size() - quality_begin) % 2);
  for (std::size_t beam = 0; beam < beams.size(); beam += 2) {
    const auto nibble = [&](std::size_t index) {
      return index < beams.size() ? static_cast<int>(check.within("quality", beams[index].quality, 0, 15))
                                  : 0;
    };
    packet.put<std::uint8_t>(quality_begin + beam / 2,
                             static_cast<std::uint8_t>(nibble(beam) | nibble(beam + 1) << 4));
  }
  for (const Reson8101Beam& beam : beams) packet.append<std::uint16_t>(beam.intensity);

  const auto bytes = packet.bytes();
  packet.append<std::uint16_t>(static_cast<std::uint16_t>(std::accumulate(bytes.begin(), bytes.end(), 0u)));
  return {packet.bytes().begin(), packet.bytes().end()};
}

}  // namespace tubefoot
