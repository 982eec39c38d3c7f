// SPDX-License-Identifier: GPL-3.0-or-later
// Tests ARIS files with an independent reader: each field, models by beam number, range gates in whole
// microseconds, and amplitude codes.

#include "sensors/formats/aris_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "fixtures/refusal.hpp"
#include "fixtures/world/camera_frames.hpp"

namespace tubefoot {
namespace {

using camera_file::expect_fields;
using camera_file::Fields;
using camera_file::Reader;
using camera_file::single;
using camera_file::with_one_frame;
using ::testing::HasSubstr;

TEST(ArisFile, every_field_of_the_format_is_as_told_or_zero) {
  const TestFolder folder;
  ArisHeader told;
  told.title = "mine-like objects";
  told.beams = 128;
  told.samples = 1000;
  told.window = {2000, 8};
  told.sound_speed_m_s = 1480;
  told.frame_rate_hz = 6.55;
  told.pulse_width_us = 12;
  told.telephoto_lens = true;
  told.water_temperature_c = 11.3;
  told.salinity = ArisSalinity::brackish;
  told.serial_number = 417;
  const std::vector<std::uint8_t> dark(128 * 1000);
  CameraFrame frame = camera_file::frame_of_a_dive(dark);
  {
    ArisFile file(folder / "a.aris", told);
    file.add(frame);
    file.add(frame);
    EXPECT_EQ(file.frames(), 2u);
    file.finish();
  }
  const Reader reader(folder / "a.aris");
  const double size = 1024 + 2 * (1024 + 128 * 1000);
  EXPECT_EQ(reader.size(), size);
  EXPECT_EQ(bytes_of(folder / "a.aris").substr(0, 4), "DDF\x05");
  // 2000 us of sound at 1480 m/s, in both directions, are 1.48 m; 1000 samples of 8 us 5.92 m.
  expect_fields(reader.file_fields(), Fields{{"Version", 0x05464444},
                                             {"FrameCount", 2},
                                             {"FrameRate", 7},
                                             {"HighResolution", 1},
                                             {"NumRawBeams", 128},
                                             {"SampleRate", 125000},
                                             {"SamplesPerChannel", 1000},
                                             {"WindowStart", single(1.48)},
                                             {"WindowLength", single(5.92)},
                                             {"SN", 417},
                                             {"strDate", "2006-11-09_115456"},
                                             {"strHeaderID", "mine-like objects"},
                                             {"FrameInterval", 1},
                                             {"Sspd", 1480},
                                             {"WaterTemp", 0},  // 5 to 15 degrees
                                             {"Salinity", 1},   // brackish
                                             {"FileSize", size},
                                             {"LargeLens", 1}});
  Fields wanted{{"FrameTime", 1163073296789000},
                {"Version", 0x05464444},
                {"sonarTimeStamp", 1163073296789000},
                {"TS_Day", 9},
                {"TS_Hour", 11},
                {"TS_Minute", 54},
                {"TS_Second", 56},
                {"TS_Hsecond", 79},
                {"WindowStart", single(1.48)},
                {"WindowLength", single(5.92)},
                {"WaterTemp", single(11.3)},
                {"SampleRate", 125000},
                {"PingMode", 9},
                {"FrequencyHiLow", 1},
                {"PulseWidth", 12},
                {"CyclePeriod", 2000 + 8000 + 420},
                {"SamplePeriod", 8},
                {"TransmitEnable", 1},
                {"FrameRate", single(6.55)},
                {"SoundSpeed", 1480},
                {"SamplesPerBeam", 1000},
                {"Enable150V", 1},
                {"SampleStartDelay", 2000},
                {"LargeLens", 1},
                {"TheSystemType", 1},
                {"SonarSerialNumber", 417},
                {"ReorderedSamples", 1},
                {"Salinity", 15}};
  wanted.merge(camera_file::fields_of_a_dive());
  expect_fields(reader.frame_fields(0), wanted);
  wanted["FrameIndex"] = 1;
  expect_fields(reader.frame_fields(1), wanted);
}

// The header of the file has codes for values that are numbers in the frames.
TEST(ArisFile, its_header_says_the_water_that_its_frames_are_in) {
  const TestFolder folder;
  const struct {
    ArisSalinity salinity;
    double temperature_c;
    unsigned salinity_code, temperature_code;
  } waters[] = {{ArisSalinity::fresh, 4, 0, 0},     {ArisSalinity::brackish, 15, 1, 1},
                {ArisSalinity::salt, 24.9, 2, 1},   {ArisSalinity::salt, 25, 2, 2},
                {ArisSalinity::brackish, 33, 1, 2}, {ArisSalinity::salt, -1.8, 2, 0}};
  const std::vector<std::uint8_t> dark(96 * 512);
  for (const auto& water : waters) {
    ArisHeader told;
    told.salinity = water.salinity;
    told.water_temperature_c = water.temperature_c;
    const Reader reader = with_one_frame<ArisFile>(folder / "water.aris", told, dark);
    EXPECT_EQ(reader.file_fields().at("Salinity").number, water.salinity_code);
    EXPECT_EQ(reader.file_fields().at("WaterTemp").number, water.temperature_code);
    EXPECT_EQ(reader.number(0, "Salinity"), static_cast<double>(water.salinity));
    EXPECT_NEAR(reader.number(0, "WaterTemp"), water.temperature_c, 1e-5);
  }
}

TEST(ArisFile, each_number_of_beams_has_its_ping_mode_and_model) {
  const TestFolder folder;
  const unsigned seed = 48649;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  struct Case {
    int beams, samples;
    std::optional<ArisModel> model;
    double ping_mode, system_type;
  };
  for (const Case& expected :
       {Case{48, 300, {}, 1, 0}, Case{48, 301, ArisModel::aris_1200, 1, 2}, Case{96, 1, {}, 3, 0},
        Case{64, 999, {}, 6, 1}, Case{128, 2000, ArisModel::aris_3000, 9, 1}}) {
    ArisHeader told;
    told.beams = expected.beams;
    told.samples = expected.samples;
    told.model = expected.model;
    told.high_frequency = false;
    const auto columns = static_cast<std::size_t>(expected.beams),
               rows = static_cast<std::size_t>(expected.samples);
    std::vector<std::uint8_t> picture(columns * rows);
    for (auto& amplitude : picture) amplitude = static_cast<std::uint8_t>(random());
    const Reader reader = with_one_frame<ArisFile>(folder / "a.aris", told, picture);
    ASSERT_EQ(reader.beams, columns);
    ASSERT_EQ(reader.samples_per_beam, rows);
    ASSERT_EQ(reader.frames, 1u);
    EXPECT_EQ(reader.number(0, "PingMode"), expected.ping_mode);
    EXPECT_EQ(reader.number(0, "TheSystemType"), expected.system_type);
    EXPECT_EQ(reader.number(0, "FrequencyHiLow"), 0);
    EXPECT_GE(reader.number(0, "CyclePeriod"), 1802);
    for (std::size_t beam = 0; beam < columns; ++beam)
      for (std::size_t sample = 0; sample < rows; ++sample)
        ASSERT_EQ(reader.amplitude(0, sample, columns - 1 - beam), picture[beam * rows + sample]);
  }
}

TEST(ArisFile, headers_no_aris_has_are_refused_before_a_file_is_made) {
  const TestFolder folder;
  const auto refused = [&](auto change) {
    ArisHeader told;
    change(told);
    const std::string said = refusal([&] { ArisFile(folder / "a.aris", told); });
    EXPECT_THAT(said, HasSubstr((folder / "a.aris").string()));
    EXPECT_FALSE(std::filesystem::exists(folder / "a.aris"));
    return said;
  };
  const double nan = std::nan("");
  for (const int beams : {0, -48, 1, 47, 100, 256})
    EXPECT_THAT(refused([&](ArisHeader& told) { told.beams = beams; }), HasSubstr("48, 64, 96 or 128"));
  EXPECT_THAT(refused([](ArisHeader& told) { told.model = ArisModel::aris_3000; }),
              HasSubstr("ARIS 3000 has 64 or 128"));
  EXPECT_THAT(refused([](ArisHeader& told) { told.model = ArisModel::aris_1200; }),
              HasSubstr("96 beams do not fit"));
  for (const int samples : {0, -1, 65536})
    EXPECT_THAT(refused([&](ArisHeader& told) { told.samples = samples; }), HasSubstr("number of samples"));
  for (const unsigned delay : {0u, 929u, 65536u})
    EXPECT_THAT(refused([&](ArisHeader& told) { told.window.start_delay_us = delay; }), HasSubstr("delay"));
  for (const unsigned period : {0u, 3u, 101u})
    EXPECT_THAT(refused([&](ArisHeader& told) { told.window.sample_period_us = period; }),
                HasSubstr("period"));
  EXPECT_THAT(refused([](ArisHeader& told) {
                told.window = {65535 - 420 - 512 * 100 + 1, 100};
              }),
              HasSubstr("65536, but must be at most 65535 us"));
  for (const double bad : {0.0, -1.0, nan, static_cast<double>(INFINITY)}) {
    EXPECT_THAT(refused([&](ArisHeader& told) { told.sound_speed_m_s = bad; }), HasSubstr("speed of sound"));
    EXPECT_THAT(refused([&](ArisHeader& told) { told.frame_rate_hz = bad; }), HasSubstr("frame rate"));
  }
  for (const unsigned width : {3u, 101u})
    EXPECT_THAT(refused([&](ArisHeader& told) { told.pulse_width_us = width; }), HasSubstr("pulse"));
  EXPECT_THAT(refused([&](ArisHeader& told) { told.water_temperature_c = nan; }), HasSubstr("temperature"));
}

TEST(ArisWindow, metres_come_from_whole_microseconds) {
  const ArisWindow window = aris_window(1.48, 5.92, 1000, 1480);
  EXPECT_EQ(window.start_delay_us, 2000u);
  EXPECT_EQ(window.sample_period_us, 8u);
  EXPECT_DOUBLE_EQ(window.start_m(1480), 1.48);
  EXPECT_DOUBLE_EQ(window.length_m(1480, 1000), 5.92);
}

TEST(ArisWindow, every_window_is_found_again_up_to_half_a_sample_off) {
  const unsigned seed = 1202;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int trial = 0; trial < 20000; ++trial) {
    const ArisWindow told{std::uniform_int_distribution<std::uint32_t>(930, 65535)(random),
                          std::uniform_int_distribution<std::uint32_t>(4, 100)(random)};
    const int samples = std::uniform_int_distribution(1, 4000)(random);
    const double speed = std::uniform_real_distribution(1400.0, 1600.0)(random);
    // The length changes by up to 0.49 of a sample, but stays nearest to its period. The start changes by
    // 0.49 us.
    const double shift = std::uniform_real_distribution(-0.49, 0.49)(random);
    const double microsecond_m = 1e-6 * speed / 2;
    const double start_m = told.start_m(speed) + shift * microsecond_m;
    const double length_m = told.length_m(speed, samples) +
                            shift * std::min<double>(told.sample_period_us, samples) * microsecond_m;
    const ArisWindow found = aris_window(start_m, length_m, samples, speed);
    ASSERT_EQ(found.start_delay_us, told.start_delay_us);
    ASSERT_EQ(found.sample_period_us, told.sample_period_us);
  }
}

TEST(ArisWindow, a_window_between_two_sample_periods_is_refused_with_both) {
  // 512 samples over 5 m at 1500 m/s are 13.02 us apart: 13 us make 4.992 m, 14 us 5.376 m.
  const std::string said = refusal([] { aris_window(2.1, 5, 512, 1500); });
  EXPECT_THAT(said, HasSubstr("4.992000 (13 us)"));
  EXPECT_THAT(said, HasSubstr("5.376000 (14 us)"));
  EXPECT_NO_THROW(aris_window(2.1, 4.992, 512, 1500));
  EXPECT_THAT(refusal([] { aris_window(2.1, 1, 1000, 1500); }), HasSubstr("3.000000 (4 us)"));
  EXPECT_THAT(refusal([] { aris_window(2.1, 100, 1000, 1500); }), HasSubstr("75.000000 (100 us)"));
  EXPECT_THAT(refusal([] { aris_window(0.5, 4.992, 512, 1500); }), HasSubstr("0.6975 to 49.15"));
  EXPECT_THAT(refusal([] { aris_window(50, 4.992, 512, 1500); }), HasSubstr("window_start_m"));
  for (const double bad :
       {std::nan(""), static_cast<double>(INFINITY), -1.0, -static_cast<double>(INFINITY)}) {
    EXPECT_THROW(aris_window(bad, 4.992, 512, 1500), std::invalid_argument);
    EXPECT_THROW(aris_window(2.1, bad, 512, 1500), std::invalid_argument);
    EXPECT_THROW(aris_window(2.1, 4.992, 512, bad), std::invalid_argument);
  }
  EXPECT_THROW(aris_window(2.1, 4.992, 0, 1500), std::invalid_argument);
}

TEST(ArisWindow, the_nearest_is_one_that_is_found_again_or_none) {
  for (const double speed : {1402.0, 1448.7, 1500.0, 1543.2, 1560.0}) {
    const auto near = nearest_aris_window(0.699, 4.992, 512, speed);
    ASSERT_TRUE(near) << speed;
    EXPECT_NEAR(near->length_m(speed, 512), 4.992, 512 * 0.5e-6 * speed / 2 + 1e-9);
    EXPECT_GE(near->start_m(speed), 0.699 - 0.5e-6 * speed / 2 - 1e-9);
    EXPECT_LE(near->start_m(speed), std::max(0.699 + 0.5e-6 * speed / 2, 930e-6 * speed / 2) + 1e-9);
    const ArisWindow again = aris_window(near->start_m(speed), near->length_m(speed, 512), 512, speed);
    EXPECT_EQ(again.start_delay_us, near->start_delay_us);
    EXPECT_EQ(again.sample_period_us, near->sample_period_us);
  }
  EXPECT_FALSE(nearest_aris_window(1, 512 * 101e-6 * 750, 512, 1500)) << "samples of 101 us";
  EXPECT_FALSE(nearest_aris_window(1, 512 * 3e-6 * 750, 512, 1500));
  EXPECT_FALSE(nearest_aris_window(50, 5, 512, 1500)) << "after 65535 us";
}

TEST(ArisAmplitude, eighty_decibels_fill_the_byte) {
  EXPECT_EQ(aris_amplitude(0), 0);
  EXPECT_EQ(aris_amplitude(80), 255);
  EXPECT_EQ(aris_amplitude(40), 128);  // 127.5: halves round up
  EXPECT_EQ(aris_amplitude(-INFINITY), 0);
  EXPECT_EQ(aris_amplitude(81), 255);
  EXPECT_THROW(aris_amplitude(std::nan("")), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
