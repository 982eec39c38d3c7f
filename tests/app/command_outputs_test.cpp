// SPDX-License-Identifier: GPL-3.0-or-later
// Tests each command that writes, on a full disk and in a read-only folder. An earlier file stays
// unchanged, no partial file remains, and the message names the file. The destination of messages may be
// full as well.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct CommandOutputs : testing::Test {
  TestFolder folder;
  const std::string scene = (folder / "scene.toml").string(), rippled = (folder / "rippled.toml").string(),
                    echoes = (folder / "results" / "echoes.nc").string();
  struct Command {
    std::vector<std::string> words;
    std::string output;
  };
  std::vector<Command> commands;
  CommandOutputs() {
    folder.write("scene.toml", replaced(small_scene, "beams = 4", "beams = 2\nsamples = 64"));
    folder.write("thing.obj", tetrahedron);
    fs::create_directory(folder / "out");
    const std::string out = (folder / "out").string() + "/";
    commands = {
        {{"footprints", scene, "--sensor", "camera", "--quiet", "-o", out + "f.csv"}, out + "f.csv"},
        {{"footprints", scene, "--sensor", "camera", "--quiet", "-o", out + "f.gpkg"}, out + "f.gpkg"},
        {{"coverage", scene, "--quiet", "-o", out + "c.csv"}, out + "c.csv"},
        {{"coverage", scene, "--quiet", "-o", out + "d.csv", "--picture", out + "c.png"}, out + "c.png"},
        {{"view", scene, "--quiet", "-o", out + "v.html"}, out + "v.html"},
        {{"advise", scene, "--quiet", "--tolerance", "1dB", "--json", out + "a.json"}, out + "a.json"},
        {{"compare", echoes, echoes, "--json", out + "e.json"}, out + "e.json"},
        {{"compare", echoes, echoes, "--png", out + "e.png"}, out + "e.png"},
        {{"refine", rippled, "--quiet", "-o", out + "bed.ply"}, out + "bed.ply"}};
  }
  void SetUp() override {
    folder.write("rippled.toml", replaced(small_scene, "[[terrain]]", R"([[materials.relief]]
kind = "ripples"
tile_m = 5.12
resolution_m = 0.04
seed = 7
wavelength_m = 0.4
rms_height_m = 0.02
[relief]
cell_m = 0.5
mode = "offline"
[[terrain]]
name = "bed"
material = "sand")"));
    const Outcome outcome = run_program({"run", scene, "--quiet", "-o", (folder / "results").string()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
};

TEST_F(CommandOutputs, OutliveAFullDisk) {
  for (const Command& command : commands) {
    SCOPED_TRACE(command.output);
    const Outcome written = run_program(command.words);
    ASSERT_EQ(written.exit_code, 0) << written.err;
    ASSERT_TRUE(fs::remove(command.output));
    const std::string earlier = "an earlier file";
    folder.write("out/" + fs::path(command.output).filename().string(), earlier);
    const auto before = names_below(folder.path());
    Surroundings full_disk;
    full_disk.largest_file_bytes = 40;
    const Outcome outcome = run_program(command.words, full_disk);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(fs::path(command.output).filename().string()));
    EXPECT_EQ(bytes_of(command.output), earlier);
    EXPECT_EQ(names_below(folder.path()), before);
  }
}

TEST_F(CommandOutputs, InAFolderThatMayNotBeWrittenAreRefused) {
  if (!nobody_can_run_program()) GTEST_SKIP() << "the program lies where only its owner may run it";
  Surroundings nobody;
  nobody.as_nobody = true;
  if (geteuid() != 0) fs::permissions(folder / "out", fs::perms(0555));
  const auto before = names_below(folder.path());
  for (const Command& command : commands) {
    SCOPED_TRACE(command.output);
    const Outcome outcome = run_program(command.words, nobody);
    EXPECT_NE(outcome.exit_code, 0);
    EXPECT_EQ(outcome.signal, 0);
    EXPECT_THAT(outcome.err,
                testing::AllOf(HasSubstr(fs::path(command.output).filename().string()),
                               testing::AnyOf(HasSubstr("ermission denied"), HasSubstr("unable to open"))));
    EXPECT_EQ(names_below(folder.path()), before);
  }
  fs::permissions(folder / "out", fs::perms(0755));
}

TEST_F(CommandOutputs, OfAChartOutliveAFullDisk) {
  const std::string charts = (folder / "charts").string();
  const std::vector<std::string> words{"chart",     scene, "--quiet",   "-o",  charts,
                                       "--repeats", "1",   "--seconds", "0.05"};
  Surroundings full_disk;
  full_disk.largest_file_bytes = 40;
  const auto nothing = names_below(folder.path());
  EXPECT_EQ(run_program(words, full_disk).exit_code, 1);
  EXPECT_EQ(names_below(folder.path()), nothing);

  ASSERT_EQ(run_program(words).exit_code, 0);
  const auto before = names_below(folder.path());
  const std::string table = bytes_of(folder / "charts" / "chart.csv");
  const Outcome outcome = run_program(words, full_disk);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("charts/"));
  EXPECT_EQ(names_below(folder.path()), before);
  EXPECT_EQ(bytes_of(folder / "charts" / "chart.csv"), table);
}

/// Applies redirections of streams in a shell before it starts the program.
Surroundings with_streams(const std::string& redirected) {
  Surroundings surroundings;
  surroundings.before = {"/bin/sh", "-c", "exec \"$0\" \"$@\" " + redirected};
  return surroundings;
}

// A long run continues if its log is on a full disk or its terminal was closed.
TEST_F(CommandOutputs, RunsOutliveALogThatCannotBeWritten) {
  const fs::path unreceived = folder / "unheard";
  for (const std::string redirected : {"2>/dev/full", "2>&-", "<&- 2>&-"}) {
    SCOPED_TRACE(redirected);
    const Outcome outcome = run_program({"run", scene, "-o", unreceived.string()}, with_streams(redirected));
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.signal, 0);
    EXPECT_EQ(bytes_of(unreceived / "echoes.nc"), bytes_of(echoes));
    EXPECT_EQ(run_program({"check", "nowhere.toml"}, with_streams(redirected)).exit_code, 2);
  }
}

TEST_F(CommandOutputs, WhatCannotBePrintedIsAFailure) {
  const fs::path unprinted = folder / "unprinted";
  const std::vector<std::vector<std::string>> printing{{"run", scene, "--quiet", "-o", unprinted.string()},
                                                       {"check", scene, "--quiet"},
                                                       {"presets"},
                                                       {"keys"},
                                                       {"--help"},
                                                       {"compare", echoes, echoes, "--json", "-"}};
  for (const std::vector<std::string>& words : printing) {
    SCOPED_TRACE(testing::PrintToString(words));
    const Outcome outcome = run_program(words, with_streams(">/dev/full"));
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.err, "tubefoot: cannot write to standard output: No space left on device\n");
  }
  EXPECT_EQ(bytes_of(unprinted / "echoes.nc"), bytes_of(echoes));
  EXPECT_EQ(run_program({"check", scene, "--quiet"}, with_streams(">&-")).exit_code, 1);
}

}  // namespace
}  // namespace tubefoot
