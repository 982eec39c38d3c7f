// SPDX-License-Identifier: GPL-3.0-or-later
// Of every command that writes: on a disk that is full, in a folder that may not be written, an earlier file
// stays as it was, no half one is left, and the message names it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "app/program.hpp"
#include "app/small_scene.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct CommandOutputs : testing::Test {
  TestFolder folder;
  const std::string scene = (folder / "scene.toml").string();
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
        {{"advise", scene, "--quiet", "--tolerance", "1dB", "--json", out + "a.json"}, out + "a.json"}};
  }
};

TEST_F(CommandOutputs, OutliveAFullDisk) {
  for (const Command& command : commands) {
    SCOPED_TRACE(command.output);
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

}  // namespace
}  // namespace tubefoot
