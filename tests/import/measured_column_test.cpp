// SPDX-License-Identifier: GPL-3.0-or-later
// Tests echo files of measured water columns. Built columns with known codes give the energies of the sonar
// equation in the right beams and range bins.
#include "import/measured_column.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fixtures/kmall_builder.hpp"
#include "fixtures/kmall_recordings.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

using kmall_for_tests::Beam;
using kmall_for_tests::Column;
using kmall_for_tests::Line;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

using ProgramWords = std::vector<std::string>;

struct MeasuredColumns : testing::Test {
  TestFolder folder;
  Line line = kmall_for_tests::two_modes();
  std::string output = (folder / "measured.nc").string();

  MeasuredColumns() {
    for (std::size_t ping = 0; ping < line.columns.size(); ++ping) {
      Column& column = line.columns[ping];
      column.gain_exponent = 30 + ping;
      column.gain_offset_db = int(ping) - 3;
      for (std::size_t b = 0; b < column.beams.size(); ++b) {
        Beam& beam = column.beams[b];
        beam.first_sample = 10 + 5 * b;
        for (std::size_t k = 0; k < beam.levels.size(); ++k)
          beam.levels[k] = int((7 * k + 31 * b + 11 * ping) % 200) - 128;
      }
      column.beams[1].fine_sample = 0;
    }
  }
  void write_line() const {
    folder.write("line.kmall", line.soundings_file());
    folder.write("line.kmwcd", line.column_file());
  }
  std::string name(const std::string& of) const { return (folder / of).string(); }
  void import_line(const ProgramWords& options = {}) const {
    write_line();
    ProgramWords words{"import", name("line.kmwcd"), "-o", output};
    words.insert(words.end(), options.begin(), options.end());
    const Outcome outcome = run_program(words);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  /// Expects that the program rejects the words with a message that contains the text.
  static void expect_rejected(const ProgramWords& words, const std::string& text) {
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(text));
  }

  /// The pings of a mode in the file.
  std::vector<const Column*> columns_of(const std::string& mode) const {
    std::vector<const Column*> columns;
    for (const Column& column : line.columns)
      if ((column.sectors.size() == 2) == (mode == "mode-200-300")) columns.push_back(&column);
    return columns;
  }
  static double range_m(const Column& column, double sample) {
    return column.speed_m_s * sample / (2 * column.rate_hz);
  }
  /// Beams from port to starboard.
  static std::vector<const Beam*> ordered(const Column& column) {
    std::vector<const Beam*> beams;
    for (const Beam& beam : column.beams) beams.push_back(&beam);
    std::ranges::sort(beams, std::greater(), &Beam::angle_deg);
    return beams;
  }

  void expect_energies() const {
    for (const std::string mode : {"mode-200-300", "mode-400"}) {
      SCOPED_TRACE(mode);
      const Echoes echoes = read_echoes(output, mode);
      const auto columns = columns_of(mode);
      ASSERT_EQ(echoes.pings, columns.size());
      std::size_t compared = 0;
      for (std::size_t ping = 0; ping < echoes.pings; ++ping) {
        const Column& column = *columns[ping];
        const auto beams = ordered(column);
        ASSERT_EQ(echoes.beams, beams.size());
        for (std::size_t b = 0; b < beams.size(); ++b)
          for (std::size_t bin = 0; bin < echoes.samples; ++bin) {
            const double sample = echoes.slant_range_m[bin] * 2 * column.rate_hz / column.speed_m_s;
            ASSERT_NEAR(sample, std::round(sample), 1e-3);
            const double k = std::round(sample) - double(beams[b]->first_sample);
            double expected = 0;
            if (k >= 0 && k < double(beams[b]->levels.size()) && beams[b]->levels[std::size_t(k)] != -128) {
              const double range = range_m(column, std::round(sample));
              const double alpha_db_per_m = (beams[b]->sector == 0 ? 60 : 90) / 1000.0;
              const double level_db = 0.5 * beams[b]->levels[std::size_t(k)] -
                                      double(column.gain_exponent) * std::log10(range) -
                                      2 * alpha_db_per_m * range - column.gain_offset_db;
              expected = std::pow(10, level_db / 10);
              ++compared;
            }
            ASSERT_NEAR(echoes.at(ping, b, bin), expected, 1e-4 * expected)
                << "ping " << ping << " beam " << b << " bin " << bin;
          }
      }
      EXPECT_GT(compared, 1000u);
    }
  }
};

TEST_F(MeasuredColumns, HaveTheEnergiesOfTheCodesWithoutTheGain) {
  import_line();
  expect_energies();
}

TEST_F(MeasuredColumns, InOrderFromStarboardAreReversed) {
  for (Column& column : line.columns) std::ranges::reverse(column.beams);
  import_line();
  expect_energies();
  const Echoes echoes = read_echoes(output, "mode-400");
  EXPECT_LT(echoes.beam_azimuth_deg.front(), 0) << "beam 0 is the port-most one";
  EXPECT_GT(echoes.beam_azimuth_deg.back(), 0);
}

TEST_F(MeasuredColumns, HaveTheRecordedAndTheDetectedRanges) {
  import_line();
  const NetcdfReader file(output);
  for (const std::string mode : {"mode-200-300", "mode-400"}) {
    SCOPED_TRACE(mode);
    const std::string group = "/" + mode;
    const auto nearest = file.values(group, "recorded_range_min"),
               farthest = file.values(group, "recorded_range_max"),
               detected = file.values(group, "detected_range");
    EXPECT_EQ(file.dimensions(group, "detected_range"), "ping,beam");
    std::size_t at = 0;
    for (const Column* column : columns_of(mode))
      for (const Beam* beam : ordered(*column)) {
        const double first = double(beam->first_sample), count = double(beam->levels.size());
        EXPECT_NEAR(nearest.at(at), range_m(*column, first - 0.5), 1e-4);
        EXPECT_NEAR(farthest.at(at), range_m(*column, first + count - 0.5), 1e-4);
        if (beam->fine_sample > 0)
          EXPECT_NEAR(detected.at(at), range_m(*column, beam->fine_sample), 1e-3);
        else
          EXPECT_TRUE(std::isnan(detected.at(at)));
        ++at;
      }
    EXPECT_EQ(at, detected.size());
  }
  EXPECT_EQ(file.text("/", "engine"), "measured");
}

TEST_F(MeasuredColumns, HaveDetectionsWithinTheSwathOnly) {
  for (kmall_for_tests::Ping& ping : line.pings) {
    ping.swath_port_deg = 25;
    ping.swath_starboard_deg = -35;
  }
  import_line();
  const auto detected = NetcdfReader(output).values("/mode-400", "detected_range");
  ASSERT_EQ(detected.size(), 9u);
  for (std::size_t ping = 0; ping < 3; ++ping) {
    EXPECT_TRUE(std::isnan(detected[3 * ping])) << "the beam at 30 degrees to port";
    EXPECT_FALSE(std::isnan(detected[3 * ping + 2])) << "the beam at 30 degrees to starboard";
  }
}

TEST_F(MeasuredColumns, OfTheImportedSceneAreEqual) {
  import_line();
  const Echoes without = read_echoes(output, "mode-400");
  ASSERT_EQ(run_program({"import-scene", name("line.kmall"), "-o", name("scene"), "--quiet"}).exit_code, 0);
  output = name("with-scene.nc");
  import_line({"--scene", name("scene/scene.toml")});
  EXPECT_EQ(read_echoes(output, "mode-400").energy, without.energy);
  EXPECT_EQ(read_echoes(output, "mode-400").ping_time_s, without.ping_time_s);
}

TEST_F(MeasuredColumns, EqualThemselvesInAComparison) {
  import_line();
  for (const std::string mode : {"mode-200-300", "mode-400"}) {
    const Outcome outcome = run_program({"compare", output, output, "--sensor", mode, "--within-db", "1e-9"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
}

TEST_F(MeasuredColumns, OfTheRepositorysRecordingHaveItsSeabed) {
  const Outcome outcome = run_program({"import", repository_recording.string(), "-o", output});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("4 sensors, 5 pings, 256 beams"));
  const Echoes echoes = read_echoes(output, "mode-260-320-290");
  ASSERT_EQ(echoes.beams, 256u);
  const auto detected = NetcdfReader(output).values("/mode-260-320-290", "detected_range");
  // In the inner beams, the largest energy lies near the detection.
  std::size_t near_detection = 0;
  for (std::size_t beam = 98; beam < 158; ++beam) {
    std::size_t largest = 0;
    for (std::size_t k = 0; k < echoes.samples; ++k)
      if (echoes.at(0, beam, k) > echoes.at(0, beam, largest)) largest = k;
    near_detection += std::abs(echoes.slant_range_m[largest] - detected.at(beam)) < 0.3 ? 1 : 0;
  }
  EXPECT_GE(near_detection, 55u);
}

TEST_F(MeasuredColumns, WithOptionsOfPicturesAreRejected) {
  write_line();
  const std::string column = name("line.kmwcd");
  expect_rejected({"import", column, "-o", name("measured.txt")}, "must end in .nc");
  expect_rejected({"import", column, "-o", output, "--sensor", "mode-400"}, "only --scene and -o apply");
  expect_rejected({"import", column, "-o", output, "--strict"}, "only --scene and -o apply");
  expect_rejected({"import", column, "-o", output, "--flip-beams"}, "only --scene and -o apply");
  folder.write("other.nc", "");
  expect_rejected({"import", column, "-o", output, "--like", name("other.nc")}, "only --scene and -o apply");
  EXPECT_FALSE(std::filesystem::exists(output));
}

TEST_F(MeasuredColumns, OfSeveralFilesAreRejected) {
  write_line();
  folder.write("two.kmall", line.soundings_file());
  folder.write("two.kmwcd", line.column_file());
  expect_rejected({"import", name("line.kmwcd"), name("two.kmwcd"), "-o", output}, "give one file .kmwcd");
}

TEST_F(MeasuredColumns, NameTheMissingFile) {
  write_line();
  std::filesystem::remove(folder / "line.kmall");
  expect_rejected({"import", name("line.kmwcd"), "-o", output}, "needs the file 'line.kmall'");
  expect_rejected({"import", name("absent.kmwcd"), "-o", output}, "absent.kmwcd");
}

TEST_F(MeasuredColumns, OfAnotherSceneAreRejected) {
  write_line();
  ASSERT_EQ(run_program({"import-scene", name("line.kmall"), "-o", name("scene"), "--quiet"}).exit_code, 0);
  const std::string scene = bytes_of(folder / "scene/scene.toml");
  const auto rejected = [&](const std::string& from, const std::string& to, const std::string& text) {
    std::string changed = scene;
    changed.replace(changed.find(from), from.size(), to);
    folder.write("scene/changed.toml", changed);
    expect_rejected({"import", name("line.kmwcd"), "-o", output, "--scene", name("scene/changed.toml")},
                    text);
  };
  rejected("mode-400", "mode-401", "has no sensor 'mode-400'");
  const std::size_t second = scene.find("ping_times_s = [", scene.find("mode-400"));
  const std::string times = scene.substr(second, scene.find(']', second) + 1 - second);
  rejected(times, "ping_times_s = [1.5, 2.5]", "2 pings of 3 beams, but the recording has 3 of 3");
}

}  // namespace
}  // namespace tubefoot
