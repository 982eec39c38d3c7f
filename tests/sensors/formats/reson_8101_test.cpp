// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the 8101 packet, alone and inside an XTF file, with its table and with the geometry of a flat
// bottom.
#include "sensors/formats/reson_8101.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "fixtures/packet_reader.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/formats/xtf_file.hpp"

namespace tubefoot {
namespace {

using samples::nan;
using samples::PacketReader;
using testing::HasSubstr;
using testing::IsEmpty;

Reson8101Settings settings() {
  Reson8101Settings settings;
  settings.sound_speed_m_s = 1480;
  settings.range_m = 100;
  settings.ping_rate_hz = 6.73;
  settings.pulse_s = 75e-6;
  settings.power = 6;
  settings.gain = 33;
  settings.time_varied_gain = true;
  settings.spreading = 30.25;
  settings.absorption_db_per_km = 70;
  settings.projector_angle_deg = -1.5;
  settings.head_temperature_c = -1.8;
  settings.sonar_id = 0x01020304;
  settings.sample_rate_hz = 40000;
  return settings;
}

PacketReader packet_of(const Reson8101Settings& sonar, const std::vector<Reson8101Beam>& beams,
                       double unix_time_s = 1735689599.25) {
  return {reson_8101_packet(sonar, unix_time_s, 70000, beams, "here"), true};
}

/// The sum of all bytes before the last two.
void expect_checksum(PacketReader& packet) {
  unsigned sum = 0;
  for (std::size_t k = 0; k + 2 < packet.size(); ++k) sum += packet.u8(k);
  EXPECT_EQ(packet.u16(packet.size() - 2), sum % 65536);
}

TEST(Reson8101, PacketHasEachFieldInItsPlace) {
  const std::vector<Reson8101Beam> beams{{0.0625, kBrightness | kColinearity | kPhaseDetection, 600},
                                         {0, 0, 0},
                                         {0.1, kAmplitudeDetection, 65535}};
  PacketReader packet = packet_of(settings(), beams);
  ASSERT_EQ(packet.size(), 68u + 6 + 2 + 6 + 2);
  EXPECT_EQ(packet.u32(0), 0xFFFF0000u);
  EXPECT_EQ(packet.u8(4), 0x18u);
  EXPECT_EQ(packet.u32(8), 1735689599u);
  EXPECT_EQ(packet.u32(12), 250u);
  EXPECT_EQ(packet.u32(16), 70000u);
  EXPECT_EQ(packet.u32(20), 0x01020304u);
  EXPECT_EQ(packet.u16(24), 8101u);
  EXPECT_EQ(packet.u16(26), 240u);
  EXPECT_EQ(packet.u16(28), 1480u);
  EXPECT_EQ(packet.u16(30), 40000u);
  EXPECT_EQ(packet.u16(32), 6730u);
  EXPECT_EQ(packet.u16(34), 100u);
  EXPECT_EQ(packet.u16(36), 6u);
  EXPECT_EQ(packet.u16(38), 33u + 0x4000);
  EXPECT_EQ(packet.u16(40), 75u);
  EXPECT_EQ(packet.u8(42), 121u);
  EXPECT_EQ(packet.u8(43), 70u);
  EXPECT_EQ(packet.u8(45), 15u);
  EXPECT_EQ(packet.u16(46), 15u);
  EXPECT_EQ(packet.u16(48), 10u);
  EXPECT_EQ(packet.i16(50), -150);
  EXPECT_EQ(packet.i16(64), -18);
  EXPECT_EQ(packet.i16(66), 3);
  EXPECT_EQ(packet.u16(68), 10000u);  // 0.0625 s in quarters of 25 us
  EXPECT_EQ(packet.u16(70), 0u);
  EXPECT_EQ(packet.u16(72), 16000u);
  EXPECT_EQ(packet.u8(74), 0x0Bu);  // beam 0 in the low half, beam 1 in the high one
  EXPECT_EQ(packet.u8(75), 0x04u);
  EXPECT_EQ(packet.u16(76), 600u);
  EXPECT_EQ(packet.u16(78), 0u);
  EXPECT_EQ(packet.u16(80), 65535u);
  expect_checksum(packet);
  EXPECT_THAT(packet.unread(), IsEmpty());
}

// One step of a double (0.24 us) early, a typical result of arithmetic.
TEST(Reson8101, TimesAreNotEarly) {
  PacketReader packet = packet_of(settings(), {{0, 0, 0}}, std::nextafter(1735689599.07, 0));
  EXPECT_EQ(packet.u32(8), 1735689599u);
  EXPECT_EQ(packet.u32(12), 70u);
}

// The qualities of 101 beams fill 51 bytes. Some readers expect 52, so that all intensities lie one byte
// later.
TEST(Reson8101, OddQualitiesEndAsRequested) {
  std::vector<Reson8101Beam> beams(101, {0.05, kBrightness, 7});
  PacketReader packet = packet_of(settings(), beams);
  ASSERT_EQ(packet.size(), 68u + 202 + 51 + 202 + 2);
  EXPECT_EQ(packet.u16(68 + 202 + 51), 7u);
  expect_checksum(packet);

  Reson8101Settings even = settings();
  even.even_quality_length = true;
  PacketReader padded = packet_of(even, beams);
  ASSERT_EQ(padded.size(), 68u + 202 + 52 + 202 + 2);
  EXPECT_EQ(padded.u8(68 + 202 + 51), 0u);
  EXPECT_EQ(padded.u16(68 + 202 + 52), 7u);
  expect_checksum(padded);

  beams.resize(100);
  EXPECT_EQ(packet_of(even, beams).size(), packet_of(settings(), beams).size());
}

// Without a sampling rate in the scene, the rate just represents the range setting: a time of 2 R / c fits
// its field. Unless the rate has its maximum, a rate 1 Hz higher would not fit.
TEST(Reson8101, SampleRateHoldsTheRangeSettingAndNoMore) {
  for (const double range_m : {1., 20., 100., 187., 300., 1000., 5000.}) {
    Reson8101Settings sonar = settings();
    sonar.sample_rate_hz.reset();
    sonar.range_m = range_m;
    const double farthest_s = 2 * range_m / sonar.sound_speed_m_s;
    PacketReader packet = packet_of(sonar, {{farthest_s, 0, 0}});
    const double rate = packet.u16(30);
    EXPECT_NEAR(packet.u16(68) * 0.25 / rate, farthest_s, 0.125 / rate) << range_m;
    EXPECT_TRUE(rate == 65535 || 4 * (rate + 1) * farthest_s > 65535) << range_m << " m: " << rate << " Hz";
  }
}

// A flat bottom 20 m below, beams -75 to 75 degrees from port: c t / 2 = 20 / cos(angle), to half a count.
// A wall 10 m to port gives the first beams.
TEST(Reson8101, FlatBottomAndAWallToPortAreReadBack) {
  Reson8101Settings sonar = settings();
  sonar.sample_rate_hz.reset();
  std::vector<Reson8101Beam> beams;
  std::vector<double> slant_m;
  for (int beam = 0; beam < 101; ++beam) {
    const double starboard_rad = (-75 + 1.5 * beam) * std::numbers::pi / 180;
    double range_m = 20 / std::cos(starboard_rad);
    if (starboard_rad < 0) range_m = std::min(range_m, 10 / std::sin(-starboard_rad));
    slant_m.push_back(range_m);
    beams.push_back({2 * range_m / sonar.sound_speed_m_s, kBrightness | kColinearity, 100});
  }
  PacketReader packet = packet_of(sonar, beams);
  const double spacing_deg = double(packet.u16(46)) / packet.u16(48);
  const int count = packet.i16(66);
  for (int beam = 0; beam < count; ++beam) {
    const double time_s = 0.25 * packet.u16(68 + 2 * static_cast<std::size_t>(beam)) / packet.u16(30);
    const double range_m = 0.5 * packet.u16(28) * time_s;
    EXPECT_NEAR(range_m, slant_m[static_cast<std::size_t>(beam)], 0.125 * 1480 / 2 / packet.u16(30)) << beam;
    // As in MB-System: across angle (n / 2 - i) * spacing, positive to port.
    const double port_rad = (count / 2 - beam) * spacing_deg * std::numbers::pi / 180;
    if (port_rad > std::atan(0.5) + 1e-6) {
      EXPECT_NEAR(range_m * std::sin(port_rad), 10, 0.01) << beam;
    } else {
      EXPECT_NEAR(range_m * std::cos(port_rad), 20, 0.01) << beam;
    }
  }
}

TEST(Reson8101, TravelsInAnXtfPacketOfType2) {
  const TestFolder folder;
  const auto path = folder / "reson.xtf";
  const std::vector<Reson8101Beam> beams(101, {0.05, kBrightness, 7});
  XtfPlace place;
  place.unix_time_s = 1735689599.25;
  place.ping_number = 70000;
  place.roll_deg = -3.25;
  {
    XtfHeader header;
    header.bathymetry = XtfChannel{};
    XtfFile file(path, header);
    file.add_reson_8101_ping(place, settings(), beams);
    file.finish();
  }
  const auto bytes = samples::file_content(path);
  PacketReader packet(std::span<const unsigned char>(bytes).subspan(1024), false);
  EXPECT_EQ(packet.size(), 832u);  // 256 + 525, in blocks of 64
  EXPECT_EQ(packet.u16(0), 0xFACEu);
  EXPECT_EQ(packet.u8(2), 2u);
  EXPECT_EQ(packet.u16(4), 0u);
  EXPECT_EQ(packet.u32(10), 832u);
  EXPECT_EQ(packet.u32(28), 70000u);
  EXPECT_EQ(packet.f32(208), -3.25f);
  EXPECT_EQ(packet.part(256, 525), reson_8101_packet(settings(), 1735689599.25, 70000, beams, "here"));
  for (std::size_t k = 256 + 525; k < 832; ++k) EXPECT_EQ(packet.u8(k), 0u);
}

TEST(Reson8101, RefusesWhatItsFieldsDoNotHold) {
  const auto refuse = [](const std::function<void(Reson8101Settings&, Reson8101Beam&)>& spoil,
                         const char* what) {
    Reson8101Settings sonar = settings();
    Reson8101Beam beam{0.05, 0, 0};
    spoil(sonar, beam);
    try {
      packet_of(sonar, {{0.05, 0, 0}, beam});
      ADD_FAILURE() << "not refused: " << what;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr("here: "));
      EXPECT_THAT(error.what(), HasSubstr(what));
    }
  };
  for (const double value : {nan, infinite, -1., 0.})
    refuse([&](auto& sonar, auto&) { sonar.sound_speed_m_s = value; }, "sound speed");
  refuse([](auto& sonar, auto&) { sonar.sound_speed_m_s = 65536; }, "sound speed");
  for (const double value : {nan, infinite, 0., 65536.})
    refuse([&](auto& sonar, auto&) { sonar.range_m = value; }, "range setting");
  for (const double value : {nan, 0., 65536.})
    refuse([&](auto& sonar, auto&) { sonar.sample_rate_hz = value; }, "sample rate");
  refuse([](auto& sonar, auto&) { sonar.ping_rate_hz = 66; }, "ping rate");
  refuse([](auto& sonar, auto&) { sonar.pulse_s = 1; }, "pulse");
  refuse([](auto& sonar, auto&) { sonar.frequency_khz = nan; }, "frequency");
  refuse([](auto& sonar, auto&) { sonar.power = 9; }, "power");
  refuse([](auto& sonar, auto&) { sonar.power = -1; }, "power");
  refuse([](auto& sonar, auto&) { sonar.gain = 0; }, "gain");
  refuse([](auto& sonar, auto&) { sonar.gain = 46; }, "gain");
  refuse([](auto& sonar, auto&) { sonar.spreading = 64; }, "spreading");
  refuse([](auto& sonar, auto&) { sonar.absorption_db_per_km = 256; }, "absorption");
  refuse([](auto& sonar, auto&) { sonar.along_track_width_deg = 26; }, "along-track width");
  refuse([](auto& sonar, auto&) { sonar.beam_spacing_deg = -1; }, "beam spacing");
  refuse([](auto& sonar, auto&) { sonar.projector_angle_deg = 328; }, "projector angle");
  refuse([](auto& sonar, auto&) { sonar.head_temperature_c = nan; }, "head temperature");
  for (const double value : {nan, infinite, -0.01, 0.41})  // 0.41 s: 65600 quarters of a sample
    refuse([&](auto&, auto& beam) { beam.two_way_time_s = value; }, "two-way time");
  refuse([](auto&, auto& beam) { beam.quality = 16; }, "quality");
  EXPECT_THROW(packet_of(settings(), {}), std::invalid_argument);
  EXPECT_THROW(packet_of(settings(), std::vector<Reson8101Beam>(32768)), std::invalid_argument);
  for (const double time_s : {nan, -1., 4294967296.})
    EXPECT_THROW(packet_of(settings(), {{0, 0, 0}}, time_s), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
