// SPDX-License-Identifier: GPL-3.0-or-later
// Tests DIDSON (DDF) files with an independent reader: each field, orientation of beams, codes of range
// gates, frame rates, and amplitude codes.

#include "sensors/formats/ddf_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

DdfHeader ddf_header() {
  DdfHeader made;
  made.sample_rate_hz = ddf_sample_rate_hz(5);
  return made;
}

DdfHeader low_resolution() {
  DdfHeader made = ddf_header();
  made.high_resolution = false;
  made.beams = 48;
  return made;
}

DdfHeader with_flags(bool high_resolution, std::uint32_t flags) {
  DdfHeader made = high_resolution ? ddf_header() : low_resolution();
  made.config_flags = flags;
  return made;
}

TEST(DdfFile, every_field_of_the_format_is_as_told_or_zero) {
  const TestFolder folder;
  DdfHeader told = ddf_header();
  told.title = "wreck of the Scotsman";
  told.window = {5, 2};
  told.frame_rate_hz = 6.5;
  told.sound_speed_m_s = 1499.6;
  told.water_temperature_c = 11.3;
  told.serial_number = 417;
  const std::vector<std::uint8_t> dark(96 * 512);
  CameraFrame frame = camera_file::frame_of_a_dive(dark);
  {
    DdfFile file(folder / "a.ddf", told);
    file.add(frame);
    frame.camera.reset();
    file.add(frame);
    EXPECT_EQ(file.frames(), 2u);
    file.finish();
  }
  const Reader reader(folder / "a.ddf");
  EXPECT_EQ(reader.size(), 512u + 2 * (256 + 96 * 512));
  EXPECT_EQ(reader.frames, 2u);
  EXPECT_EQ(bytes_of(folder / "a.ddf").substr(0, 4), "DDF\x03");
  expect_fields(reader.file_fields(), Fields{{"Signature", 0x03464444},
                                             {"FrameTotal", 2},
                                             {"FrameRate", 7},
                                             {"HighResolution", 1},
                                             {"NumRawBeams", 96},
                                             {"SampleRate", 76800},
                                             {"SamplesPerChannel", 512},
                                             {"WindowStart", 5},
                                             {"WindowLength", 2},
                                             {"SN", 417},
                                             {"Date", "2006-11-09_115456"},
                                             {"HeaderID", "wreck of the Scotsman"},
                                             {"FrameInterval", 1},
                                             {"Sspd", 1500}});
  Fields wanted{{"FrameTime", 1163073296},
                {"Version", 0x03464444},
                {"Year", 2006},
                {"Month", 11},
                {"Day", 9},
                {"Hour", 11},
                {"Minute", 54},
                {"Second", 56},
                {"HSecond", 79},
                {"TransmitMode", 3},
                {"WindowStart", 5},
                {"WindowLength", 2},
                {"Intensity", 90},
                {"ConfigFlags", 4},
                {"WaterTemp", single(11.3)}};
  wanted.merge(camera_file::fields_of_a_dive());
  expect_fields(reader.frame_fields(0), wanted);
  wanted["FrameNumber"] = 1;
  wanted["CompassHeading"] = 271.25;  // no attitude of its own: that of the platform
  wanted["CompassPitch"] = single(-3.4);
  wanted["CompassRoll"] = single(1.7);
  expect_fields(reader.frame_fields(1), wanted);
}

TEST(DdfFile, low_resolution_has_48_beams_and_says_so) {
  const TestFolder folder;
  const std::vector<std::uint8_t> dark(48 * 512);
  const Reader reader = with_one_frame<DdfFile>(folder / "a.ddf", low_resolution(), dark);
  EXPECT_EQ(reader.size(), 512u + 256 + 48 * 512);
  EXPECT_EQ(reader.beams, 48u);
  EXPECT_EQ(reader.file_fields().at("HighResolution").number, 0);
  EXPECT_EQ(reader.number(0, "TransmitMode"), 2);
}

TEST(DdfFile, port_ahead_is_the_last_beam_of_its_range) {
  const TestFolder folder;
  std::vector<std::uint8_t> picture(96 * 512);
  picture[3 * 512 + 300] = 200;  // the fourth beam from port, range sample 300
  with_one_frame<DdfFile>(folder / "a.ddf", ddf_header(), picture);
  const std::string bytes = bytes_of(folder / "a.ddf");
  EXPECT_EQ(bytes[512 + 256 + 300 * 96 + 92], static_cast<char>(200));
  EXPECT_EQ(std::count(bytes.begin() + 512 + 256, bytes.end(), '\0'), 96 * 512 - 1);
}

TEST(DdfFile, every_amplitude_comes_back_mirrored_and_range_by_range) {
  const TestFolder folder;
  const unsigned seed = 20061109;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::vector<std::vector<std::uint8_t>> pictures(3, std::vector<std::uint8_t>(96 * 512));
  DdfFile file(folder / "a.ddf", ddf_header());
  for (auto& picture : pictures) {
    for (auto& amplitude : picture) amplitude = static_cast<std::uint8_t>(random());
    CameraFrame frame;
    frame.amplitudes = picture;
    file.add(frame);
  }
  file.finish();
  const Reader reader(folder / "a.ddf");
  ASSERT_EQ(reader.frames, 3u);
  for (std::size_t frame = 0; frame < 3; ++frame)
    for (std::size_t beam = 0; beam < 96; ++beam)
      for (std::size_t sample = 0; sample < 512; ++sample)
        ASSERT_EQ(reader.amplitude(frame, sample, 95 - beam), pictures[frame][beam * 512 + sample]);
}

TEST(DdfFile, a_long_title_is_cut_between_characters) {
  const TestFolder folder;
  const std::vector<std::uint8_t> dark(96 * 512);
  DdfHeader told = ddf_header();
  told.title =
      std::string(254, 'x') + "\u00e9pave";  // 254 and 2 bytes: the second does not fit before the zero
  EXPECT_EQ(with_one_frame<DdfFile>(folder / "a.ddf", told, dark).file_fields().at("HeaderID").text,
            std::string(254, 'x'));
}

TEST(DdfFile, headers_no_didson_has_are_refused_before_a_file_is_made) {
  const TestFolder folder;
  const auto refused = [&](auto change) {
    DdfHeader told = ddf_header();
    change(told);
    const std::string said = refusal([&] { DdfFile(folder / "a.ddf", told); });
    EXPECT_THAT(said, HasSubstr((folder / "a.ddf").string()));
    EXPECT_FALSE(std::filesystem::exists(folder / "a.ddf"));
    return said;
  };
  const double nan = std::nan("");
  EXPECT_THAT(refused([](DdfHeader& told) { told.beams = 64; }), HasSubstr("invalid number of beams 64"));
  EXPECT_THAT(refused([](DdfHeader& told) { told.beams = 48; }), HasSubstr("high resolution has 96"));
  EXPECT_THAT(refused([](DdfHeader& told) { told.high_resolution = false; }),
              HasSubstr("low resolution has 48"));
  EXPECT_THAT(refused([](DdfHeader& told) { told.config_flags = 6; }), HasSubstr("long-range"));
  EXPECT_THAT(refused([](DdfHeader& told) { told.samples = 1024; }), HasSubstr("DDF_05"));
  EXPECT_THAT(refused([](DdfHeader& told) { told.window.start_code = 0; }), HasSubstr("start code is 0"));
  EXPECT_THAT(refused([](DdfHeader& told) { told.window.start_code = 32; }), HasSubstr("1 to 31"));
  EXPECT_THAT(refused([](DdfHeader& told) { told.window.length_code = 4; }), HasSubstr("0 to 3"));
  for (const double rate : {0.0, -1.0, nan, static_cast<double>(INFINITY)}) {
    EXPECT_THAT(refused([&](DdfHeader& told) { told.frame_rate_hz = rate; }), HasSubstr("frame rate"));
    EXPECT_THAT(refused([&](DdfHeader& told) { told.sample_rate_hz = rate; }), HasSubstr("sample rate"));
    EXPECT_THAT(refused([&](DdfHeader& told) { told.sound_speed_m_s = rate; }), HasSubstr("speed of sound"));
  }
  EXPECT_THAT(refused([&](DdfHeader& told) { told.water_temperature_c = nan; }), HasSubstr("temperature"));
}

TEST(DdfFile, frame_rates_are_whole_and_never_zero) {
  const TestFolder folder;
  const std::vector<std::uint8_t> dark(96 * 512);
  for (const auto& [rate, kept] : {std::pair{0.2, 1.0}, {1.4, 1.0}, {2.5, 3.0}, {21.0, 21.0}}) {
    DdfHeader told = ddf_header();
    told.frame_rate_hz = rate;
    EXPECT_EQ(with_one_frame<DdfFile>(folder / "a.ddf", told, dark).file_fields().at("FrameRate").number,
              kept);
  }
}

TEST(DdfWindow, lengths_are_those_of_the_formats_tables) {
  const auto expect = [](bool high_resolution, std::uint32_t flags, std::array<double, 4> lengths_m) {
    for (std::uint32_t code = 0; code < 4; ++code)
      EXPECT_EQ(ddf_window_length_m(with_flags(high_resolution, flags), code), lengths_m[code]);
  };
  for (const std::uint32_t higher : {0u, 4u, 8u}) {
    expect(true, higher + 0, {1.25, 2.5, 5, 10});
    expect(true, higher + 1, {1.125, 2.25, 4.5, 9});
    expect(true, higher + 2, {2.5, 5, 10, 20});
    expect(true, higher + 3, {2.25, 4.5, 9, 18});
    expect(false, higher + 0, {5, 10, 20, 40});
    expect(false, higher + 1, {4.5, 9, 18, 36});
    expect(false, higher + 2, {10, 20, 40, 80});
    expect(false, higher + 3, {9, 18, 36, 72});
  }
}

TEST(DdfWindow, start_steps_are_those_of_each_family_of_readers) {
  EXPECT_DOUBLE_EQ(ddf_start_step_m(ddf_header()), 0.42);
  EXPECT_DOUBLE_EQ(ddf_start_step_m(low_resolution()), 0.84);
  EXPECT_DOUBLE_EQ(ddf_start_step_m(ddf_header(), DdfStartStep::matlab), 0.419);
  EXPECT_DOUBLE_EQ(ddf_start_step_m(low_resolution(), DdfStartStep::matlab), 0.838);
  EXPECT_DOUBLE_EQ(ddf_start_step_m(ddf_header(), DdfStartStep::delay_time), 0.429);
  EXPECT_DOUBLE_EQ(ddf_start_step_m(low_resolution(), DdfStartStep::delay_time), 0.858);
  DdfHeader early = ddf_header();
  for (const auto& [serial, step_m] : {std::pair{18u, 0.384}, {19u, 0.429}}) {
    early.serial_number = serial;
    EXPECT_DOUBLE_EQ(ddf_start_step_m(early, DdfStartStep::delay_time), step_m);
  }
  early.serial_number = 100;
  early.sound_speed_m_s = 1480;
  EXPECT_DOUBLE_EQ(ddf_start_step_m(early, DdfStartStep::delay_time), 0.572e-3 * 740);
  for (const auto step : {DdfStartStep::vendor, DdfStartStep::matlab, DdfStartStep::delay_time}) {
    EXPECT_DOUBLE_EQ(ddf_start_step_m(with_flags(true, 5), step), 0.375);
    EXPECT_DOUBLE_EQ(ddf_start_step_m(with_flags(false, 5), step), 0.75);
  }
}

TEST(DdfWindow, every_undisputed_pair_of_codes_is_found_again) {
  for (const bool high_resolution : {true, false})
    for (const std::uint32_t flags : {4u, 5u, 6u, 7u})
      for (const auto step : {DdfStartStep::vendor, DdfStartStep::matlab, DdfStartStep::delay_time})
        for (std::uint32_t length = 0; length < 4; ++length)
          for (std::uint32_t start = 1; start <= 31; ++start) {
            const DdfHeader camera = with_flags(high_resolution, flags);
            const double length_m = ddf_window_length_m(camera, length);
            const double start_m = start * ddf_start_step_m(camera, step);
            const bool disputed = (high_resolution && flags == 4 && length == 0) ||
                                  (!high_resolution && flags == 6 && length == 3);
            if (disputed) {
              EXPECT_THROW(ddf_window(camera, start_m, length_m, step), std::invalid_argument);
              continue;
            }
            const DdfWindow window = ddf_window(camera, start_m, length_m, step);
            ASSERT_EQ(window.start_code, start);
            ASSERT_EQ(window.length_code, length);
          }
}

TEST(DdfWindow, half_a_range_sample_is_the_tolerance) {
  const double half_m = 5.0 / 512 / 2;
  EXPECT_EQ(ddf_window(ddf_header(), 2.1 + 0.99 * half_m, 5).start_code, 5u);
  EXPECT_EQ(ddf_window(ddf_header(), 2.1 - 0.99 * half_m, 5).start_code, 5u);
  EXPECT_THROW(ddf_window(ddf_header(), 2.1 + 1.01 * half_m, 5), std::invalid_argument);
  EXPECT_THROW(ddf_window(ddf_header(), 2.1 - 1.01 * half_m, 5), std::invalid_argument);
  EXPECT_EQ(ddf_window(ddf_header(), 2.1, 5 + 0.99 * half_m).length_code, 2u);
  EXPECT_THROW(ddf_window(ddf_header(), 2.1, 5 + 1.01 * half_m), std::invalid_argument);
}

TEST(DdfWindow, a_window_without_codes_is_refused_with_those_there_are) {
  EXPECT_THAT(refusal([] { ddf_window(ddf_header(), 2.1, 3); }), HasSubstr("2.5, 5, 10"));
  EXPECT_THAT(refusal([] { ddf_window(ddf_header(), 2.1, 1.25); }), HasSubstr("2.5, 5, 10"));
  EXPECT_THAT(refusal([] { ddf_window(low_resolution(), 0.84, 50); }), HasSubstr("5, 10, 20, 40"));
  EXPECT_THAT(refusal([] { ddf_window(ddf_header(), 2, 5); }), HasSubstr("window_start_m of 2.1"));
  EXPECT_THAT(refusal([] { ddf_window(ddf_header(), 0, 5); }), HasSubstr("window_start_m of 0.42"));
  EXPECT_THAT(refusal([] { ddf_window(ddf_header(), 14, 5); }), HasSubstr("window_start_m of 13.02"));
  for (const double bad :
       {std::nan(""), static_cast<double>(INFINITY), -1.0, -static_cast<double>(INFINITY)}) {
    EXPECT_THROW(ddf_window(ddf_header(), bad, 5), std::invalid_argument);
    EXPECT_THROW(ddf_window(ddf_header(), 2.1, bad), std::invalid_argument);
  }
  EXPECT_THROW(ddf_window(ddf_header(), 2.1, 0), std::invalid_argument);
}

TEST(DdfWindow, sample_rates_give_the_length_back_at_1500_metres_a_second) {
  EXPECT_EQ(ddf_sample_rate_hz(2.5), 153600);
  EXPECT_EQ(ddf_sample_rate_hz(5), 76800);
  EXPECT_EQ(ddf_sample_rate_hz(10), 38400);
  EXPECT_EQ(ddf_sample_rate_hz(40), 9600);
}

TEST(DdfAmplitude, ninety_decibels_fill_the_byte) {
  EXPECT_EQ(ddf_amplitude(0), 0);
  EXPECT_EQ(ddf_amplitude(90), 255);
  EXPECT_EQ(ddf_amplitude(45), 128);  // 127.5: halves round up
  EXPECT_EQ(ddf_amplitude(30), 85);
  EXPECT_EQ(ddf_amplitude(0.1764), 0);  // 0.4998
  EXPECT_EQ(ddf_amplitude(0.1766), 1);  // 0.5004
  EXPECT_EQ(ddf_amplitude(-1), 0);
  EXPECT_EQ(ddf_amplitude(-INFINITY), 0);
  EXPECT_EQ(ddf_amplitude(91), 255);
  EXPECT_EQ(ddf_amplitude(INFINITY), 255);
  EXPECT_THROW(ddf_amplitude(std::nan("")), std::invalid_argument);
  for (int value = 0; value < 256; ++value) EXPECT_EQ(ddf_amplitude(value * 90.0 / 255), value);
}

}  // namespace
}  // namespace tubefoot
