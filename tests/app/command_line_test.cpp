// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the command line: exit code 0 for completed requests, 2 for invalid ones, with help, version and
// messages.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mpfr.h>
#include <sqlite3.h>
#include <zlib.h>

#include <map>
#include <sstream>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Runs the program on the small scene in a folder of the test.
struct CommandLine : testing::Test {
  TestFolder folder;
  std::string scene = folder.write("scene.toml", small_scene).string();
  std::string output = (folder / "results").string();
  std::string table = (folder / "polygons.csv").string();
  CommandLine() { folder.write("thing.obj", tetrahedron); }

  /// Expects exit code 2, a message on stderr only, and no output files.
  void expect_refused(const std::vector<std::string>& arguments, const std::string& message) const {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{"scene.toml", "thing.obj"}));
  }
};

TEST_F(CommandLine, HelpOfEverySubcommandShowsAnExample) {
  for (const char* command : {"run", "check", "audit", "footprints", "advise"}) {
    const Outcome outcome = run_program({command, "--help"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.out, HasSubstr("Example:\n  tubefoot " + std::string(command) + " scenes/"));
    EXPECT_THAT(outcome.out, HasSubstr("SCENE"));
    EXPECT_THAT(outcome.err, IsEmpty());
  }
  const Outcome outcome = run_program({"--help"});
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* command : {"run", "check", "audit", "footprints", "advise"})
    EXPECT_THAT(outcome.out, HasSubstr("\n  " + std::string(command) + " "));
}

TEST_F(CommandLine, HelpIsACommandToo) {
  EXPECT_EQ(run_program({"help"}).out, run_program({"--help"}).out);
  EXPECT_EQ(run_program({"help", "footprints"}).out, run_program({"footprints", "--help"}).out);
  expect_refused({"help", "footprint"}, "unknown command 'footprint': did you mean 'footprints'?");
}

TEST_F(CommandLine, PresetsAreListedByAPartOfTheirName) {
  const std::string listed = run_program({"presets", "Oculus"}).out;
  std::size_t presets = 0;
  for (std::size_t at = listed.find("\noculus-"); at != std::string::npos;
       at = listed.find("\noculus-", at + 1))
    ++presets;
  EXPECT_THAT(listed, testing::StartsWith("oculus-"));
  EXPECT_EQ(presets + 1, 6u) << listed;
  EXPECT_THAT(run_program({"presets", "ping360"}).out, HasSubstr("kind = \"scanning\""));
  expect_refused({"presets", "ocullus-m750d-750"}, "did you mean 'oculus-m750d-750'?");
  expect_refused({"presets", "xyzzy"}, "no preset matches 'xyzzy': 'tubefoot presets' lists all");
}

TEST_F(CommandLine, EarlierNamesOfOptionsKeepTheirMeaningWithAWarning) {
  const Outcome labels = run_program({"run", scene, "-o", output, "--truth", "--pictures", "none"});
  EXPECT_EQ(labels.exit_code, 0) << labels.err;
  EXPECT_THAT(labels.err, HasSubstr("warning: --truth is deprecated: use --labels"));
  EXPECT_THAT(run_program({"run", scene, "-o", output + "2", "--truth", "--pictures", "none", "--quiet"}).err,
              Not(HasSubstr("deprecated")));
  const Outcome shard = run_program({"run", scene, "-o", output + "3", "--part=1/1"});
  EXPECT_EQ(shard.exit_code, 0) << shard.err;
  EXPECT_THAT(shard.err, HasSubstr("warning: --part is deprecated: use --shard"));
  EXPECT_THAT(names_below(folder.path()), testing::Contains("results3.part-1-of-1"));
  const std::string echoes = (folder / "results").string();
  const Outcome output_model =
      run_program({"compare", echoes, echoes, "--recipe", (folder / "none.toml").string()});
  EXPECT_EQ(output_model.exit_code, 2);
  EXPECT_THAT(output_model.err, HasSubstr("warning: --recipe is deprecated: use --output-model"));
  EXPECT_THAT(output_model.err, HasSubstr("none.toml"));
  const Outcome pings = run_program({"footprints", scene, "--sensor", "camera", "--ping", "0", "-o", table});
  EXPECT_EQ(pings.exit_code, 0) << pings.err;
  EXPECT_THAT(pings.err, HasSubstr("warning: --ping is deprecated: use --pings"));
  const Outcome suite = run_program({"pack", "--help"});
  EXPECT_EQ(suite.exit_code, 0) << suite.err;
  EXPECT_THAT(suite.err, HasSubstr("warning: the command 'pack' is deprecated: use 'suite'"));
  EXPECT_THAT(suite.out, HasSubstr("tubefoot suite"));
}

TEST_F(CommandLine, HelpGroupsTheOptionsOfARunByPurpose) {
  const std::string help = run_program({"run", "--help"}).out;
  std::size_t at = 0;
  for (const char* group : {"\nWhat to compute:\n", "\nHow to compute it:\n", "\nWhat to write:\n",
                            "\nWhere to write:\n", "\nExample:\n"}) {
    const std::size_t found = help.find(group);
    ASSERT_NE(found, std::string::npos) << group << help;
    EXPECT_GT(found, at);
    at = found;
  }
  EXPECT_THAT(help, HasSubstr("--engine tube|ray"));
  EXPECT_THAT(help, HasSubstr("--output FOLDER (required)"));
}

TEST_F(CommandLine, HelpOfEveryCommandFitsItsColumnsAndShowsNoTypes) {
  std::istringstream commands(run_program({"help"}).out);
  std::size_t tried = 0;
  bool listed = false;
  for (std::string line; std::getline(commands, line);) {
    listed = line.empty() ? false : listed || line.starts_with("Subcommands");
    if (!listed || !line.starts_with("  ") || line[2] == ' ') continue;
    const std::string command = line.substr(2, line.find(' ', 2) - 2);
    const std::string help = run_program({command, "--help"}).out;
    EXPECT_THAT(help, Not(HasSubstr("TEXT"))) << command;
    EXPECT_THAT(help, Not(HasSubstr(":{"))) << command;
    std::istringstream lines(help);
    for (std::string text; std::getline(lines, text);) {
      if (text.starts_with("   ")) {
        EXPECT_LE(text.size(), 100U) << text;
      }
    }
    ++tried;
  }
  EXPECT_GE(tried, 17U);
}

TEST_F(CommandLine, TheFolderOfARunStandsForItsEchoes) {
  ASSERT_EQ(run_program({"run", scene, "-o", output, "--pictures", "none"}).exit_code, 0);
  const Outcome by_folder = run_program({"compare", output, output}),
                by_file = run_program({"compare", output + "/echoes.nc", output + "/echoes.nc"});
  EXPECT_EQ(by_folder.exit_code, 0) << by_folder.err;
  EXPECT_EQ(by_folder.out, by_file.out);
  EXPECT_THAT(run_program({"compare", folder.path().string(), output}).err,
              HasSubstr("is a folder, expected an echo file (echoes.nc)"));
}

TEST_F(CommandLine, VersionIsPrinted) {
  const Outcome outcome = run_program({"--version"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out,
              testing::MatchesRegex("tubefoot [0-9]+\\.[0-9]+\\.[0-9]+\nsources: [0-9a-f]+\ncompiler: .*"));
}

TEST_F(CommandLine, VersionNamesTheBuildAndItsLibraries) {
  // Each line has a name and a version: numbers with dots. None lacks a version.
  std::map<std::string, std::string> said;
  std::istringstream lines(run_program({"--version"}).out);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos) continue;
    EXPECT_TRUE(said.emplace(line.substr(0, colon), line.substr(colon + 2)).second)
        << line << " is told twice";
  }
  for (const char* of_the_build : {"compiler", "flags", "processor", "mathematics"})
    EXPECT_THAT(said[of_the_build], testing::Not(IsEmpty())) << of_the_build;
  for (const char* library :
       {"embree",  "fftw", "geographiclib", "gdal",        "proj",     "assimp", "cgal",  "flint",
        "gmp",     "mpfr", "boost",         "tbb",         "openmesh", "netcdf", "hdf5",  "sqlite",
        "openssl", "zlib", "libzip",        "openimageio", "cairo",    "fmt",    "cli11", "nlohmann_json"})
    EXPECT_THAT(said[library], testing::MatchesRegex("[0-9]+(\\.[0-9]+)+[-.a-z0-9]*")) << library;
  // This includes libraries whose version only their packages contain.
  EXPECT_EQ(said["mpfr"], MPFR_VERSION_STRING);
  EXPECT_EQ(said["sqlite"], SQLITE_VERSION);
  EXPECT_EQ(said["zlib"], ZLIB_VERSION);
}

TEST_F(CommandLine, NumbersThatAreNoneAreRefused) {
  expect_refused({"compare", "a.nc", "b.nc", "--within", "nan"},
                 "--within: invalid value 'nan': expected a number of at least 0");
  expect_refused({"compare", "a.nc", "b.nc", "--within-db", "inf"},
                 "invalid value 'inf': expected a number of at least 0");
  for (const char* bad : {"nan", "1e999", "0"})
    expect_refused({"chart", scene, "-o", output, "--seconds", bad}, "expected a number above 0");
  expect_refused({"run", scene, "-o", output, "--rays", "nan"}, "--rays");
}

TEST_F(CommandLine, WhatCannotBeMeantIsRefused) {
  expect_refused({}, "\n  footprints ");
  expect_refused({"paint", scene}, "unknown command 'paint': 'tubefoot help' lists the commands");
  expect_refused({"run"}, "required");
  expect_refused({"run", scene}, "--output is required");
  expect_refused({"run", scene, "-o", ""}, "-o");
  expect_refused({"run", scene, "-o", output, "--pinks", "3"}, "--pinks");
  expect_refused({"run", scene, scene, "-o", output}, "scene.toml");
  expect_refused({"run", scene, "-o", output, "--engine", "beam"}, "beam not in {tube,ray}");
  expect_refused({"run", scene, "-o", output, "--arithmetic", "exact"}, "exact not in {fixed,");
  expect_refused({"run", scene, "-o", output, "--rays", "0"}, "--rays");
  expect_refused({"run", scene, "-o", output, "--rays", "many"}, "--rays");
  expect_refused({"run", scene, "-o", output, "--seed", "-1"}, "--seed");
  expect_refused({"run", scene, "-o", output, "--threads", "0"}, "--threads");
  expect_refused({"footprints", scene, "-o", table}, "--sensor is required");
  expect_refused({"footprints", scene, "--sensor", "camera"}, "--output is required");
}

TEST_F(CommandLine, PingsAndSensorsThatTheSceneLacksAreRefused) {
  for (const std::string command : {"audit", "footprints"}) {
    std::vector<std::string> words{command, scene, "--sensor", "camera"};
    if (command == "footprints") words.insert(words.end(), {"-o", table});
    for (const char* pings : {"1", "0:1", "2:1"}) {
      auto arguments = words;
      arguments.insert(arguments.end(), {"--pings", pings});
      expect_refused(arguments, "the sensor has pings 0 to 0");
    }
    for (const char* pings : {"x", "-1", "99999999999999999999"}) {
      auto arguments = words;
      arguments.push_back(std::string("--pings=") + pings);
      expect_refused(arguments, "expected pings as N, A:B, A: or :B, counted from 0");
    }
    words[3] = "kamera";
    expect_refused(words, "the scene has no sensor 'kamera'; it has 'camera'");
  }
}

TEST_F(CommandLine, CheckSaysWhatWasUnderstood) {
  const Outcome outcome = run_program({"check", scene});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* words :
       {"A tetrahedron", "facets         6 (0 degenerate, 0 duplicate", "grid unit      2^-20 m",
        "largest snap   0 m", "sensor         camera: 1 pings, 4 beams, 512 range bins", "expected cost"})
    EXPECT_THAT(outcome.out, HasSubstr(words));
  EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{"scene.toml", "thing.obj"}));
}

TEST_F(CommandLine, QuietKeepsResultsAndDropsTheRest) {
  const Outcome talkative = run_program({"run", scene, "-o", output}),
                quiet = run_program({"run", scene, "-o", output, "--quiet"});
  EXPECT_THAT(talkative.err, HasSubstr("pings 1/1"));
  EXPECT_THAT(talkative.err, Not(HasSubstr("\r"))) << "plain lines where there is no terminal";
  EXPECT_THAT(quiet.err, IsEmpty());
  EXPECT_THAT(quiet.out, HasSubstr("wrote " + output + "/echoes.nc\n"));
}

}  // namespace
}  // namespace tubefoot
