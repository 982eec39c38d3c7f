// SPDX-License-Identifier: GPL-3.0-or-later
// Tests survey lines: modes of alternating pings, pings without attitude, missing files and datagrams, and
// damaged files.
#include "kmall/kmall_survey.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "fixtures/kmall_builder.hpp"
#include "fixtures/kmall_recordings.hpp"
#include "fixtures/refusal.hpp"
#include "fixtures/test_folder.hpp"
#include "kmall/kmall_geometry.hpp"

namespace tubefoot {
namespace {

using namespace kmall_for_tests;
using testing::AllOf;
using testing::Contains;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pointwise;

struct KmallSurveys : testing::Test {
  TestFolder folder;
  Line line = two_modes();

  KmallSurvey read(bool needs_column = true) const {
    folder.write("line.kmall", line.soundings_file());
    folder.write("line.kmwcd", line.column_file());
    return read_kmall_survey(folder / "line.kmall", needs_column);
  }
  KmallSurvey read_soundings() const {
    std::filesystem::remove(folder / "line.kmwcd");
    folder.write("line.kmall", line.soundings_file());
    return read_kmall_survey(folder / "line.kmall", false);
  }
  std::string error() const {
    return refusal<InputError>([&] { read(); });
  }
};

std::vector<std::string> names_of(const KmallSurvey& survey) {
  std::vector<std::string> names;
  for (const KmallMode& mode : survey.modes) names.push_back(mode.name);
  return names;
}

std::vector<double> times_of(const KmallMode& mode) {
  std::vector<double> times_s;
  for (const KmallModePing& ping : mode.pings) times_s.push_back(ping.time_s - begin_s);
  return times_s;
}

auto near(const std::vector<double>& expected, double tolerance) {
  return Pointwise(DoubleNear(tolerance), expected);
}

TEST_F(KmallSurveys, UseNoSoundingsWithAnImpossibleAbsorption) {
  ASSERT_GE(line.pings[0].soundings.size(), 3u);
  line.pings[0].soundings[0].absorption_db_per_km = -1;
  line.pings[0].soundings[1].absorption_db_per_km = 1e6;
  const KmallSurvey survey = read();
  EXPECT_FALSE(survey.pings[0].soundings[0].is_valid);
  EXPECT_FALSE(survey.pings[0].soundings[1].is_valid);
  EXPECT_TRUE(survey.pings[0].soundings[2].is_valid);
  EXPECT_NEAR(survey.modes[0].absorptions_db_per_km[0], 60, 1e-5);
}

TEST_F(KmallSurveys, HaveAModePerCombinationOfSectorsAndBeams) {
  const KmallSurvey survey = read();
  ASSERT_THAT(names_of(survey), ElementsAre("mode-200-300", "mode-400"));
  const KmallMode &two = survey.modes[0], &one = survey.modes[1];
  EXPECT_THAT(times_of(two), near({1.125, 3.125, 5.125}, 1e-6));
  EXPECT_THAT(times_of(one), near({2.125, 4.125, 6.125}, 1e-6));
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(two.pings[k].number, 100 + 2 * k);
    EXPECT_EQ(two.pings[k].column, 2 * k);
    EXPECT_EQ(one.pings[k].column, 2 * k + 1);
  }
  // From port to starboard, positive to starboard.
  EXPECT_THAT(two.beam_angles_deg, near({-40, -20, 20, 40}, 1e-5));
  EXPECT_THAT(two.beam_numbers, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(two.sector_edges_deg, near({-41, 0, 41}, 1e-5));
  EXPECT_EQ(two.sectors.at(0).tilt_deg, 0.5);
  EXPECT_EQ(two.sectors.at(1).tilt_deg, -0.25);
  EXPECT_EQ(two.sectors.at(1).frequency_hz, 300e3);
  EXPECT_THAT(two.absorptions_db_per_km, near({60, 90}, 1e-5));
  EXPECT_EQ(two.sample_rate_hz, 10e3);
  EXPECT_EQ(two.first_sample, 10u);
  EXPECT_EQ(two.end_sample, 210u);
  EXPECT_THAT(one.beam_angles_deg, near({-30, 0, 30}, 1e-5));
  EXPECT_EQ(one.sample_rate_hz, 12.5e3);
  EXPECT_EQ(survey.pings.size(), 6u);
  EXPECT_EQ(survey.positions.size(), 1u);
  EXPECT_EQ(survey.profile.size(), 2u);
  EXPECT_THAT(survey.notes, IsEmpty());
  EXPECT_THAT(survey.inputs(), ElementsAre(folder / "line.kmall", folder / "line.kmwcd"));
}

TEST_F(KmallSurveys, AreReadByTheNameOfEitherFile) {
  read();
  EXPECT_EQ(names_of(read_kmall_survey(folder / "line.kmwcd", true)).size(), 2u);
  EXPECT_TRUE(is_kmall_name("a.kmall"));
  EXPECT_TRUE(is_kmall_name("folder/a.kmwcd"));
  EXPECT_FALSE(is_kmall_name("a.kmall.csv"));
  EXPECT_FALSE(is_kmall_name("kmall"));
}

TEST_F(KmallSurveys, MayHaveTheWaterColumnInTheFileOfTheSoundings) {
  std::string bytes = line.soundings_file();
  for (const Column& column : line.columns) bytes += datagram_of(column);
  const std::filesystem::path file = folder.write("line.kmall", bytes);
  const KmallSurvey survey = read_kmall_survey(file, true);
  EXPECT_EQ(names_of(survey).size(), 2u);
  EXPECT_EQ(survey.column_file, file);
}

TEST_F(KmallSurveys, WithoutAWaterColumnHaveTheBeamsOfTheSoundings) {
  Sounding rejected = line.pings[0].soundings[0];
  rejected.detection_type = 2;
  rejected.column_angle_deg = 77;
  rejected.time_s = std::numeric_limits<double>::infinity();
  line.pings[0].soundings.push_back(rejected);
  const KmallSurvey survey = read_soundings();
  EXPECT_FALSE(survey.column_file);
  ASSERT_THAT(names_of(survey), ElementsAre("mode-200-300", "mode-400"));
  const KmallMode& mode = survey.modes[0];
  ASSERT_EQ(mode.beam_angles_deg.size(), 4u);
  EXPECT_TRUE(std::ranges::is_sorted(mode.beam_angles_deg));
  EXPECT_EQ(mode.pings.size(), 3u);
  EXPECT_FALSE(mode.pings[0].column);
  // The samples extend beyond the last sounding.
  const double last_s = 2 * 10.0 / 1500 / std::cos(glm::radians(40.0));
  EXPECT_GT(double(mode.end_sample), last_s * mode.sample_rate_hz);
  EXPECT_LT(double(mode.end_sample), 2 * last_s * mode.sample_rate_hz);
  EXPECT_THAT(survey.notes, Contains(HasSubstr("there is no water column 'line.kmwcd'")));
}

TEST_F(KmallSurveys, WithoutTravelTimesOrSampleRatesAreRejected) {
  line.pings[0].column_rate_hz = 0;
  EXPECT_THAT(refusal<InputError>([&] { read_soundings(); }),
              AllOf(HasSubstr("line.kmall"), HasSubstr("ping 100"), HasSubstr("0 samples per second")));
  for (const double rate_hz : {1e-3, -1e4, 1e30}) {  // less than one sample, and too many
    line.pings[0].column_rate_hz = rate_hz;
    EXPECT_THAT(refusal<InputError>([&] { read_soundings(); }), HasSubstr("ping 100"));
  }
}

TEST_F(KmallSurveys, WithOtherBeamAnglesAreVariants) {
  for (Beam& beam : line.columns[2].beams) beam.angle_deg *= 0.5;
  for (Beam& beam : line.columns[4].beams) beam.angle_deg *= 0.25;
  const KmallSurvey survey = read();
  EXPECT_THAT(names_of(survey),
              ElementsAre("mode-200-300", "mode-400", "mode-200-300-variant-2", "mode-200-300-variant-3"));
  EXPECT_THAT(survey.modes[2].beam_angles_deg, near({-20, -10, 10, 20}, 1e-5));
  EXPECT_THAT(times_of(survey.modes[2]), near({3.125}, 1e-6));
}

TEST_F(KmallSurveys, WithOtherSampleRatesAreVariants) {
  line.columns[4].rate_hz = 20e3;
  EXPECT_THAT(names_of(read()), ElementsAre("mode-200-300", "mode-400", "mode-200-300-variant-2"));
}

TEST_F(KmallSurveys, WithMoreModesThanSupportedAreRejected) {
  const Column one = line.columns[1];
  line.columns.clear();
  for (std::size_t k = 0; k <= most_kmall_modes; ++k) {
    Column other = one;
    for (Beam& beam : other.beams) beam.angle_deg += 0.1 * double(k);
    line.columns.push_back(other);
  }
  EXPECT_THAT(error(), HasSubstr("more than 64 combinations"));
  line.columns.pop_back();
  EXPECT_EQ(read().modes.size(), most_kmall_modes);
}

TEST_F(KmallSurveys, HaveTheSmallestRangeOfSamplesOfAllBeamsAndPings) {
  // Beams of this file are in order from starboard, and the first sample differs between beams.
  line.columns.erase(line.columns.begin(), line.columns.begin() + 5);
  std::ranges::reverse(line.columns[0].beams);
  std::vector<Beam>& beams = line.columns[0].beams;
  beams[0].first_sample = 30;
  beams[1].first_sample = 20;
  beams[2].first_sample = 40;
  beams[1].levels.resize(500, 7);
  const KmallSurvey survey = read();
  ASSERT_EQ(survey.modes.size(), 1u);
  EXPECT_EQ(survey.modes[0].first_sample, 20u);
  EXPECT_EQ(survey.modes[0].end_sample, 520u);
  EXPECT_THAT(survey.modes[0].beam_angles_deg, near({-30, 0, 30}, 1e-5));
  EXPECT_THAT(survey.modes[0].beam_numbers, ElementsAre(2, 1, 0));
}

TEST_F(KmallSurveys, WithVaryingTiltsHaveTheMeanAndANote) {
  line.columns[2].sectors[0].tilt_deg = 0.8;
  const KmallSurvey survey = read();
  EXPECT_NEAR(survey.modes.at(0).sectors.at(0).tilt_deg, 0.6, 1e-6);
  EXPECT_THAT(survey.notes,
              Contains(AllOf(HasSubstr("mode-200-300"), HasSubstr("vary from 0.500 to 0.800 degrees"))));
}

TEST_F(KmallSurveys, LeaveOutPingsWithoutAttitude) {
  line.motion = level_motion(1.5, 5.0, 30);
  const KmallSurvey survey = read();
  EXPECT_THAT(times_of(survey.modes.at(0)), near({2.125, 4.125}, 1e-6));
  EXPECT_THAT(times_of(survey.modes.at(1)), near({3.125, 5.125}, 1e-6));
  EXPECT_THAT(survey.notes, Contains(HasSubstr("2 pings are left out: no attitude (#SKM) within 0.2 s")));
  line.motion = level_motion(100, 105);
  EXPECT_THAT(error(), AllOf(HasSubstr("line.kmall"), HasSubstr("attitude")));
}

TEST_F(KmallSurveys, LeaveOutPingsWithoutSoundingsOfTheirFrequencies) {
  for (Sector& sector : line.columns[1].sectors) sector.frequency_hz = 500e3;
  const KmallSurvey survey = read();
  EXPECT_THAT(times_of(survey.modes.at(1)), near({4.125, 6.125}, 1e-6));
  EXPECT_THAT(survey.notes, Contains(HasSubstr("1 ping is left out: no soundings (#MRZ)")));
}

TEST_F(KmallSurveys, NoteDatagramsThatAreNotUsedOrLackAPart) {
  const auto parts = divided("#MRZ", 3, begin_s + 9, body_of(line.pings[0]), 2);
  folder.write("line.kmall", line.soundings_file() + datagram("#CPO", 0, begin_s, "x") + parts[0]);
  folder.write("line.kmwcd", line.column_file());
  EXPECT_THAT(
      read_kmall_survey(folder / "line.kmall", true).notes,
      AllOf(Contains(HasSubstr("not used: 1 #CPO")), Contains(HasSubstr("1 datagrams are left out"))));
}

TEST_F(KmallSurveys, NameTheMissingFileAndTheRemedy) {
  read();
  std::filesystem::remove(folder / "line.kmwcd");
  EXPECT_THAT(
      refusal<InputError>([&] { read_kmall_survey(folder / "line.kmall", true); }),
      AllOf(HasSubstr((folder / "line.kmall").string()), HasSubstr("no file 'line.kmwcd' beside it")));
  std::filesystem::remove(folder / "line.kmall");
  folder.write("line.kmwcd", line.column_file());
  EXPECT_THAT(refusal<InputError>([&] { read_kmall_survey(folder / "line.kmwcd", true); }),
              AllOf(HasSubstr((folder / "line.kmwcd").string()), HasSubstr("needs the file 'line.kmall'"),
                    HasSubstr("copy it into the same folder")));
}

/// A file without the datagrams of a type.
std::string without(const std::string& bytes, const std::string& type) {
  std::string kept;
  for (std::size_t at = 0; at < bytes.size();) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + at, sizeof length);
    if (bytes.compare(at + 4, 4, type) != 0) kept += bytes.substr(at, length);
    at += length;
  }
  return kept;
}

TEST_F(KmallSurveys, NameTheMissingDatagrams) {
  read();
  for (const char* type : {"#IIP", "#SKM", "#MRZ"}) {
    folder.write("line.kmall", without(line.soundings_file(), type));
    EXPECT_THAT(refusal<InputError>([&] { read_kmall_survey(folder / "line.kmall", true); }),
                AllOf(HasSubstr((folder / "line.kmall").string()), HasSubstr(type)));
  }
  folder.write("line.kmall", line.soundings_file());
  folder.write("line.kmwcd", without(line.column_file(), "#MWC"));
  EXPECT_THAT(refusal<InputError>([&] { read_kmall_survey(folder / "line.kmall", true); }),
              AllOf(HasSubstr((folder / "line.kmwcd").string()), HasSubstr("#MWC")));
  // The profile and the positions are optional.
  folder.write("line.kmwcd", line.column_file());
  folder.write("line.kmall", without(without(line.soundings_file(), "#SVP"), "#SPO"));
  const KmallSurvey survey = read_kmall_survey(folder / "line.kmall", true);
  EXPECT_TRUE(survey.profile.empty());
  EXPECT_TRUE(survey.positions.empty());
}

TEST_F(KmallSurveys, WithHeadsThatAreNotInstalledAreRejected) {
  line.pings[1].transmitter = 1;
  EXPECT_THAT(error(), AllOf(HasSubstr("datagram #MRZ at byte"), HasSubstr("transmitter 2")));
  line.pings[1].transmitter = 0;
  line.pings[1].receiver = 200;
  EXPECT_THAT(error(), HasSubstr("receiver 201"));
}

TEST_F(KmallSurveys, WithAnyDamagedByteAreReadOrRejected) {
  line.pings.resize(2);
  line.columns.resize(2);
  for (Column& column : line.columns)
    for (Beam& beam : column.beams) beam.levels.resize(12);
  std::string whole = line.soundings_file();
  for (const Column& column : line.columns) whole += datagram_of(column);
  std::mt19937 random(7);
  std::size_t accepted = 0, rejected = 0;
  for (std::size_t at = 0; at < whole.size(); at += 1 + random() % 6) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(std::array{0x00, 0x7f, 0x80, 0xff}[random() % 4]);
    folder.write("damaged.kmall", damaged);
    try {
      const KmallSurvey survey = read_kmall_survey(folder / "damaged.kmall", false);
      residuals_of(survey);
      ++accepted;
    } catch (const InputError&) {
      ++rejected;
    }
  }
  EXPECT_GT(accepted, 50u);
  EXPECT_GT(rejected, 50u);
}

TEST(KmallRecordings, OfTheRepositoryHasFourModes) {
  const KmallSurvey survey = read_kmall_survey(repository_recording, true);
  EXPECT_THAT(names_of(survey),
              ElementsAre("mode-190-220", "mode-260-320-290", "mode-320-380-320", "mode-680"));
  std::vector<std::size_t> pings;
  for (const KmallMode& mode : survey.modes) {
    pings.push_back(mode.pings.size());
    EXPECT_EQ(mode.beam_angles_deg.size(), 256u);
    EXPECT_TRUE(std::ranges::is_sorted(mode.beam_angles_deg));
  }
  EXPECT_THAT(pings, ElementsAre(2, 1, 1, 1));
  EXPECT_EQ(survey.pings.size(), 6u);
}

TEST(MotionAt, IsLinearBetweenSamples) {
  const std::vector<KmallMotion> motion{{10, 1, -2, 90, 0.5}, {10.5, 3, 0, 100, -0.5}};
  const KmallMotion at = motion_at(motion, 10.125).value();
  EXPECT_EQ(at.time_s, 10.125);
  EXPECT_NEAR(at.roll_deg, 1.5, 1e-12);
  EXPECT_NEAR(at.pitch_deg, -1.5, 1e-12);
  EXPECT_NEAR(at.heading_deg, 92.5, 1e-12);
  EXPECT_NEAR(at.heave_m, 0.25, 1e-12);
  for (const KmallMotion& sample : motion) {
    EXPECT_NEAR(motion_at(motion, sample.time_s)->heading_deg, sample.heading_deg, 1e-12);
    EXPECT_NEAR(motion_at(motion, sample.time_s)->heave_m, sample.heave_m, 1e-12);
  }
}

TEST(MotionAt, TurnsTheShortWayThroughNorth) {
  for (const auto& [from, to] : {std::pair(359.0, 3.0), std::pair(3.0, 359.0)}) {
    const std::vector<KmallMotion> motion{{0, 0, 0, from, 0}, {1, 0, 0, to, 0}};
    for (const double time_s : {0.0, 0.25, 0.5, 1.0}) {
      const double expected = from > to ? 359 + 4 * time_s : 3 - 4 * time_s;
      EXPECT_NEAR(std::remainder(motion_at(motion, time_s)->heading_deg - expected, 360), 0, 1e-12);
    }
  }
}

TEST(MotionAt, ContinuesAtMostAFifthOfASecondBeyondTheSamples) {
  std::vector<KmallMotion> motion;
  for (int k = 0; k <= 100; ++k) {
    const double time_s = 20 + 0.01 * k;
    motion.push_back({time_s, 2 * time_s, -time_s, 359.9 + 10 * (time_s - 20), 0.5 * time_s});
  }
  for (const double time_s : {19.81, 19.9, 21.05, 21.19}) {
    const KmallMotion at = motion_at(motion, time_s).value();
    EXPECT_NEAR(at.roll_deg, 2 * time_s, 1e-9);
    EXPECT_NEAR(at.pitch_deg, -time_s, 1e-9);
    EXPECT_NEAR(std::remainder(at.heading_deg - 359.9 - 10 * (time_s - 20), 360), 0, 1e-9);
    EXPECT_NEAR(at.heave_m, 0.5 * time_s, 1e-9);
  }
  // An error of the last sample, 0.01 s after the one before it, does not dominate the rates.
  motion.back().roll_deg += 0.02;
  motion.front().pitch_deg += 0.02;
  EXPECT_NEAR(motion_at(motion, 21.1)->roll_deg, 2 * 21.1, 0.05);
  EXPECT_NEAR(motion_at(motion, 19.9)->pitch_deg, -19.9, 0.05);
  EXPECT_FALSE(motion_at(motion, 19.79));
  EXPECT_FALSE(motion_at(motion, 21.21));
  EXPECT_FALSE(motion_at({}, 20));
  EXPECT_FALSE(motion_at({motion[0]}, 20));
}

}  // namespace
}  // namespace tubefoot
