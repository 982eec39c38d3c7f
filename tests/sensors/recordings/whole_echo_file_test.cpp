// SPDX-License-Identifier: GPL-3.0-or-later
// Tests complete echo files: the recording is recovered, with attributes, lines, beams and variables of
// other programs.

#include "sensors/recordings/whole_echo_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "files/input_error.hpp"
#include "fixtures/foreign_echoes.hpp"
#include "fixtures/test_folder.hpp"
#include "fixtures/world/recordings.hpp"
#include "sensors/recordings/read_recording.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;
using testing::ThrowsMessage;

struct EchoFileAsAWhole : testing::Test {
  TestFolder folder;
  std::filesystem::path file = folder / "echoes.nc";
};

/// A moving camera with pings at 2 s and 2.5 s and distinct energies.
samples::OwnedRecording moving_camera(int pings) {
  auto camera = samples::silent(samples::camera(4, 8), pings);
  for (std::size_t k = 0; k < camera.energies.size(); ++k) camera.energies[k] = 1e-9 * double(k + 1);
  for (std::size_t p = 0; p < camera.recording.pings(); ++p) {
    camera.recording.ping_time_s[p] = 2 + 0.5 * double(p);
    camera.recording.ping_pose[p].position_m = {double(p), 10 + double(p), -3};
    camera.recording.ping_pose[p].attitude = attitude_from_angles(0.3 * double(p), 0.1, -0.2);
  }
  camera.recording.sound_speed_m_s = 1481.25;
  camera.recording.absorption_db_per_km = 612.5;
  return camera;
}

TEST_F(EchoFileAsAWhole, GivesBackTheRecordingThatWasWritten) {
  const auto camera = moving_camera(3);
  write_echoes(file, {camera.recording}, {"A test", "0123abcd", "tube", "fixed", "0.1.0"});
  const WholeEchoFile whole = read_whole_echo_file(file);
  const ReadRecording read = recording_of(whole, 0);
  const Recording &expected = camera.recording, &found = read.recording;
  EXPECT_EQ(std::vector<double>(found.energy.begin(), found.energy.end()), camera.energies);
  EXPECT_EQ(found.ping_time_s, expected.ping_time_s);
  EXPECT_EQ(found.sound_speed_m_s, 1481.25);
  EXPECT_EQ(found.absorption_db_per_km, 612.5);
  EXPECT_EQ(found.sensor->description().name, "camera");
  EXPECT_EQ(found.sensor->frequency_khz(), expected.sensor->frequency_khz());
  EXPECT_EQ(found.sensor->samples().count, 8);
  EXPECT_NEAR(found.sensor->samples().first_m, expected.sensor->samples().first_m, 1e-12);
  EXPECT_NEAR(found.sensor->samples().step_m, expected.sensor->samples().step_m, 1e-12);
  EXPECT_FALSE(found.sensor->is_across_track());
  ASSERT_THAT(found.sensor->beams(), SizeIs(4));
  for (std::size_t b = 0; b < 4; ++b) {
    EXPECT_NEAR(found.sensor->beams()[b].azimuth_rad, expected.sensor->beams()[b].azimuth_rad, 1e-14);
    EXPECT_NEAR(found.sensor->beams()[b].elevation_width_rad, expected.sensor->beams()[b].elevation_width_rad,
                1e-14);
  }
  ASSERT_THAT(found.ping_pose, SizeIs(3));
  EXPECT_EQ(found.ping_pose[2].position_m, expected.ping_pose[2].position_m);
  EXPECT_NEAR(std::abs(glm::dot(found.ping_pose[2].attitude, expected.ping_pose[2].attitude)), 1, 1e-14);
}

TEST_F(EchoFileAsAWhole, KeepsAttributesOfFileAndSensorApart) {
  const auto camera = moving_camera(2);
  write_echoes(file, {camera.recording}, {"A test", "0123abcd", "tube", "fixed", "0.1.0"});
  const WholeEchoFile whole = read_whole_echo_file(file);
  const auto names = [](const std::vector<EchoAttribute>& attributes) {
    std::vector<std::string> all;
    for (const EchoAttribute& a : attributes) all.push_back(a.name);
    return all;
  };
  EXPECT_THAT(names(whole.more.at(0).attributes),
              ElementsAre("sensor_name", "sensor_kind", "frequency_khz", "source_energy", "sound_speed_m_s",
                          "absorption_db_per_km"));
  EXPECT_THAT(names(whole.attributes), testing::IsSupersetOf({"title", "engine", "scene_hash"}));
  EXPECT_THAT(names(whole.attributes), testing::Not(testing::Contains("sensor_name")));
}

TEST_F(EchoFileAsAWhole, KnowsLinesAndBeamsThatLookDown) {
  ForeignGroup group = least_echoes();
  group.dimensions = {{"ping", 2}, {"beam", 3}, {"sample", 4}};
  group.variables["beam_azimuth"].values = {-90, 90, 90};
  group.variables["beam_elevation"] = {{"beam"}, "degree", {-60, -90, -50}};
  group.variables["line"] = {{"ping"}, "1", {1, 2}};
  write_foreign(file, group);
  const WholeEchoFile whole = read_whole_echo_file(file);
  const ReadRecording read = recording_of(whole, 0);
  EXPECT_TRUE(read.sensor->is_across_track());
  EXPECT_THAT(read.recording.line_starts, ElementsAre(0, 1));
  EXPECT_THAT(read.recording.ping_time_s, ElementsAre(0, 1));  // none in the file
  EXPECT_EQ(read.recording.ping_pose.at(1).position_m, glm::dvec3(0));
  EXPECT_EQ(read.sensor->samples().first_m, 1.75);
  EXPECT_EQ(read.sensor->samples().step_m, 0.5);
}

TEST_F(EchoFileAsAWhole, ReadsTheVariablesOfStrangersWhateverTheirTypeAndShape) {
  ForeignGroup group = least_echoes();
  group.dimensions.emplace_back("colour", 2);
  group.variables["share"] = {{"ping", "colour"}, "1", {1, 2, 3, NAN}};
  group.variables["number"] = {{"ping"}, std::nullopt, {7, 8}, NC_INT};
  write_foreign(file, group);
  const WholeEchoFile whole = read_whole_echo_file(file);
  const EchoVariable* share = whole.more.at(0).variable("share");
  ASSERT_NE(share, nullptr);
  EXPECT_THAT(share->dimensions, ElementsAre("ping", "colour"));
  EXPECT_THAT(share->shape, ElementsAre(2, 2));
  EXPECT_EQ(share->units, "1");
  EXPECT_EQ(share->values[2], 3);
  EXPECT_TRUE(std::isnan(share->values[3]));
  ASSERT_NE(whole.more.at(0).variable("number"), nullptr);
  EXPECT_THAT(whole.more.at(0).variable("number")->values, ElementsAre(7, 8));
  EXPECT_EQ(whole.more.at(0).variable("energy"), nullptr);  // SensorEchoes contains it
}

TEST_F(EchoFileAsAWhole, HasNoPictureOfUnevenSamples) {
  ForeignGroup group = least_echoes();
  group.variables["slant_range"].values = {2, 2.5, 3, 4};
  write_foreign(file, group);
  const WholeEchoFile whole = read_whole_echo_file(file);
  EXPECT_THAT([&] { recording_of(whole, 0); },
              ThrowsMessage<InputError>(HasSubstr("the samples of sensor 'sensor' are not evenly spaced")));
}

TEST(PickedPings, AreThoseOfTheirNumbersAndOfTheFirstChannel) {
  auto camera = moving_camera(5);
  camera.recording.line_starts = {0, 2, 4};
  const ReadRecording read = picked(camera.recording, {4, 1, 0});
  EXPECT_THAT(read.recording.ping_time_s, ElementsAre(4, 2.5, 2));
  EXPECT_THAT(read.recording.line_starts, ElementsAre(0, 1));
  EXPECT_EQ(read.recording.energy_of(1)[3], camera.energy(1, 0, 3));
  EXPECT_EQ(read.recording.energy_of(0)[31], camera.energy(4, 3, 7));
  EXPECT_EQ(read.recording.ping_pose[0].position_m.x, 4);
  EXPECT_NO_THROW(check(read.recording));
}

}  // namespace
}  // namespace tubefoot
