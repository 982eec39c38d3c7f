// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the DIDSON or ARIS file of an acoustic camera: the choice of format, levels, positions, and the
// reason for a missing file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "fixtures/camera_file_reader.hpp"
#include "fixtures/world/recordings.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/kinds/kind_didson.hpp"
#include "sensors/products/camera_files.hpp"

namespace tubefoot {
namespace {

using camera_file::Reader;
using ::testing::HasSubstr;

class CameraFiles : public testing::Test {
 protected:
  /// A recording of three pings 0.1 s apart, with 0.5 m of motion per ping.
  samples::OwnedRecording recording(SensorDescription description) { return samples::silent(description, 3); }
  std::vector<std::filesystem::path> write(const samples::OwnedRecording& made) {
    return write_camera_files(folder.path(), made.recording, run, warnings);
  }

  TestFolder folder;
  RunContext run;
  std::vector<std::string> warnings;
};

TEST_F(CameraFiles, OfADidsonKeepLevelsBelowTheBrightestOfTheRecording) {
  auto made = recording(samples::camera());
  // 0.1 % of 2000 echoes is 2: the third brightest is the reference.
  for (std::size_t k = 0; k < 1997; ++k) made.energy(k % 3, 10 + k / 512, k % 512) = 1e-9 * std::pow(10, -3);
  made.energy(0, 90, 300) = 1;
  made.energy(1, 90, 300) = 1;
  made.energy(2, 90, 300) = 1e-9;
  run.start_unix_s = 1e9;
  run.title = "a title";
  ASSERT_EQ(write(made), std::vector<std::filesystem::path>{"camera.ddf"});
  EXPECT_TRUE(warnings.empty());
  const Reader file(folder / "camera.ddf");
  EXPECT_FALSE(file.aris);
  EXPECT_EQ(file.frames, 3u);
  EXPECT_EQ(file.beams, 96u);
  EXPECT_EQ(file.number(2, "WindowStart"), 2);   // 0.84 m
  EXPECT_EQ(file.number(2, "WindowLength"), 2);  // 5 m
  EXPECT_EQ(file.amplitude(0, 300, 95 - 90), 255);
  EXPECT_EQ(file.amplitude(2, 300, 95 - 90), 255);
  EXPECT_EQ(file.amplitude(0, 0, 95 - 10), std::lround(255.0 * (90 - 30) / 90)) << "30 dB below";
  EXPECT_EQ(file.amplitude(0, 301, 95 - 90), 0) << "no echo";
  EXPECT_EQ(file.number(2, "Second"), 40) << "10^9 s is 1:46:40";
  EXPECT_EQ(file.number(2, "HSecond"), 20);
}

TEST_F(CameraFiles, OfADidsonSayWhereThePlatformIsAndHowItLooks) {
  SensorDescription description = samples::camera();
  description.tilt_deg = 30;
  auto made = recording(description);
  for (std::size_t k = 0; k < 3; ++k) {
    Pose carrier{{0.3 * double(k), 0.4 * double(k), -7},
                 attitude_from_angles(std::atan2(0.3, 0.4), 0.05, -0.1)};
    made.recording.ping_pose[k] = made.sensor->pose_on(carrier);
    made.recording.altitude_m.push_back(k == 1 ? std::nan("") : 2.5);
  }
  run.frame = LocalFrame::at_lat_lon(60, -5, 0);
  ASSERT_EQ(write(made).size(), 1u);
  const Reader file(folder / "camera.ddf");
  EXPECT_NEAR(file.number(0, "Heading"), std::atan2(0.3, 0.4) / degree, 1e-4);
  EXPECT_NEAR(file.number(0, "Pitch"), 0.05 / degree, 1e-4);
  EXPECT_NEAR(file.number(0, "Roll"), -0.1 / degree, 1e-4);
  EXPECT_NEAR(file.number(0, "CompassPitch"), 0.05 / degree - 30, 0.3) << "the camera looks down";
  EXPECT_NEAR(file.number(0, "Depth"), 7, 1e-5);
  EXPECT_NEAR(file.number(1, "Velocity"), 5 * std::cos(0.05), 1e-4);  // 0.5 m in 0.1 s, bow slightly up
  EXPECT_EQ(file.number(0, "Altitude"), 2.5);
  EXPECT_EQ(file.number(1, "Altitude"), 0);
  EXPECT_NEAR(file.number(0, "Latitude"), 60, 1e-9);
  EXPECT_NEAR(file.number(0, "Longitude"), -5, 1e-9);
  EXPECT_NEAR((file.number(2, "Latitude") - 60) * 111412, 0.8, 0.01);  // metres per degree at 60 north
  EXPECT_NEAR((file.number(2, "Longitude") + 5) * 55800, 0.6, 0.01);
}

TEST_F(CameraFiles, KnowTheDidsonByItsBeamsAndFrequency) {
  const struct {
    double frequency_khz, high_resolution, flags, start_m, length_m, length_code;
  } kinds[] = {{1100, 0, 4, 0.84, 10, 1}, {1200, 1, 6, 0.84, 10, 2}, {700, 0, 6, 0.84, 40, 2}};
  for (const auto& kind : kinds) {
    SensorDescription description = samples::camera(48);
    auto& didson = description.kind.edit<DidsonDescription>();
    didson.frequency_khz = kind.frequency_khz;
    didson.window_start_m = kind.start_m;
    didson.window_length_m = kind.length_m;
    ASSERT_EQ(write(recording(description)), std::vector<std::filesystem::path>{"camera.ddf"});
    const Reader file(folder / "camera.ddf");
    EXPECT_EQ(file.file_fields().at("HighResolution").number, kind.high_resolution);
    EXPECT_EQ(file.number(0, "ConfigFlags"), kind.flags);
    EXPECT_EQ(file.number(0, "WindowLength"), kind.length_code);
  }
}

TEST_F(CameraFiles, OfOtherWindowsOrBeamsAreOfAnAris) {
  SensorDescription description = samples::camera(128, 600);
  auto& didson = description.kind.edit<DidsonDescription>();
  didson.window_start_m = 1.48;               // 2 ms in both directions at 1480 m/s
  didson.window_length_m = 600 * 8 * 740e-6;  // 8 us per sample
  auto made = recording(description);
  made.energy(1, 5, 17) = 1e-9;
  made.energy(1, 6, 17) = 1e-13;
  ASSERT_EQ(write(made), std::vector<std::filesystem::path>{"camera.aris"});
  EXPECT_FALSE(std::filesystem::exists(folder / "camera.ddf"));
  const Reader file(folder / "camera.aris");
  EXPECT_TRUE(file.aris);
  EXPECT_EQ(file.frames, 3u);
  EXPECT_EQ(file.beams, 128u);
  EXPECT_EQ(file.samples_per_beam, 600u);
  EXPECT_EQ(file.number(0, "SampleStartDelay"), 2000);
  EXPECT_EQ(file.number(0, "SamplePeriod"), 8);
  EXPECT_EQ(file.amplitude(1, 17, 127 - 5), 255);
  EXPECT_EQ(file.amplitude(1, 17, 127 - 6), std::lround(255.0 * 40 / 80)) << "40 dB below";
}

TEST_F(CameraFiles, AreNotWrittenWhereNeitherFormatFitsAndAWarningSaysWhy) {
  EXPECT_TRUE(write(recording(samples::camera(50))).empty());
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], HasSubstr("48 or 96 beams, not 50"));
  EXPECT_THAT(warnings[0], HasSubstr("ARIS"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));

  warnings.clear();
  run.start_unix_s = -1e9;  // before 1970: detected only when the file is open
  EXPECT_TRUE(write(recording(samples::camera())).empty());
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], HasSubstr("1970"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST_F(CameraFiles, NeedADiskWithRoom) {
  const auto made = recording(samples::camera());
  const samples::FullDisk full(60000);
  samples::failure_naming(folder / "camera.ddf", [&] { write(made); });
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace tubefoot
