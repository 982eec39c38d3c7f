// SPDX-License-Identifier: GPL-3.0-or-later
// Tests which pictures a run writes, and its messages about writing: before the run, while it writes, and
// after.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/test_folder.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;
using Words = std::vector<std::string>;

struct RunOutputs : testing::Test {
  TestFolder folder;

  /// A camera with this number of pings, and another sonar of each kind with one ping.
  std::string scene(int frames) const {
    const auto other = [](const char* name, const char* keys) {
      return std::string("[[sensors]]\nname = \"") + name + "\"\n" + keys;
    };
    const std::string window = "samples = 20\nrange_min_m = 1\nrange_max_m = 9\n";
    return std::string(smallest_scene) +
           "beams = 6\nhorizontal_deg = 12\ntilt_deg = 30\nsamples = 40\npings = " + std::to_string(frames) +
           "\n" + other("imager", "kind = \"imaging\"\nbeams = 8\npings = 2\n") + window +
           other("side", "kind = \"sidescan\"\n") + window +
           other("multi", "kind = \"multibeam\"\nbeams = 9\n") + window +
           other("single", "kind = \"echosounder\"\n") + window +
           other("staff", "kind = \"interferometric\"\nbaseline_m = 0.01\n") + window;
  }
  void write(const std::string& text) const {
    folder.write("scene.toml",
                 replaced(text, "kind = \"fixed\"\n", "kind = \"fixed\"\nposition_m = [0, 0, 4]\n"));
  }
  Outcome run(Words words) const {
    std::filesystem::remove_all(folder / "out");
    Words all{"run", (folder / "scene.toml").string(), "-o", (folder / "out").string()};
    all.insert(all.end(), words.begin(), words.end());
    return run_program(all);
  }
  std::set<std::string> names_of(const Words& words) const {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return names_below(folder / "out");
  }
};

TEST_F(RunOutputs, HaveThePicturesThatAreRequestedOfEveryKind) {
  write(scene(3));
  const std::set<std::string> all = names_of({}), none = names_of({"--pictures", "none"}),
                              sequence = names_of({"--pictures", "sequence"});
  EXPECT_EQ(names_of({"--pictures", "all"}), all);
  for (const std::string& name : none) {
    EXPECT_THAT(name, AllOf(Not(HasSubstr(".png")), Not(HasSubstr(".exr")), Not(HasSubstr(".gif"))));
    EXPECT_THAT(all, Contains(name));
  }
  EXPECT_THAT(none, IsSupersetOf({"echoes.nc", "stats.json", "multi-soundings.csv", "single.csv",
                                  "staff-soundings.csv", "multi-depth.tif"}));
  EXPECT_THAT(sequence, IsSupersetOf({"camera-sequence.png", "imager-sequence.png", "side.png", "side.exr",
                                      "side-waterfall.png", "multi-depth.png", "single.png", "staff.png",
                                      "staff-phase.png"}));
  std::set<std::string> of_pings;
  for (const std::string& name : all)
    if (!sequence.contains(name)) of_pings.insert(name);
  EXPECT_THAT(of_pings,
              ElementsAre("camera-0000.exr", "camera-0000.png", "camera-0001.exr", "camera-0001.png",
                          "camera-0002.exr", "camera-0002.png", "imager-0000.exr", "imager-0000.png",
                          "imager-0001.exr", "imager-0001.png"));
  std::set<std::string> moving;
  for (const std::string& name : names_of({"--pictures", "sequence", "--animate"}))
    if (!sequence.contains(name)) moving.insert(name);
  EXPECT_THAT(moving, ElementsAre("camera-sequence.gif", "imager-sequence.gif"));
}

TEST_F(RunOutputs, WhatIsRequestedGoesBeforeWhatTheSceneSays) {
  write(scene(3) + "");
  const std::string text = bytes_of(folder / "scene.toml");
  folder.write("scene.toml",
               replaced(text, "name = \"camera\"\n", "name = \"camera\"\npictures = \"sequence\"\n"));
  EXPECT_THAT(names_of({"--sensor", "camera"}), Not(Contains("camera-0000.png")));
  EXPECT_THAT(names_of({"--sensor", "camera", "--pictures", "all"}), Contains("camera-0000.png"));
  EXPECT_THAT(names_of({"--sensor", "camera", "--pictures", "none"}),
              ElementsAre(".tubefoot-files", "echoes.nc", "stats.json"));
}

TEST_F(RunOutputs, RefusesPicturesThatThereAreNot) {
  write(scene(1));
  const auto refused = [&](const Words& words, const char* said) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr(said));
    EXPECT_THAT(names_below(folder.path()), ElementsAre("scene.toml"));
  };
  refused({"--pictures", "some"}, "none");
  refused({"--picture-bits", "12"}, "8");
  refused({"--pictures", "none", "--animate"}, "leave out one of them");
}

// Tests of messages during the run are Progress.* and Pictures.TellHowManyOfThemThereAreWhileTheyAreDrawn.
TEST_F(RunOutputs, TellWritingBeforeAndAfter) {
  write(scene(320));
  const Outcome checked = run_program({"check", (folder / "scene.toml").string()});
  EXPECT_THAT(checked.out,
              ContainsRegex("expected cost .* then about [0-9.]+ (s|minutes) for writing files"));
  std::smatch disk;
  ASSERT_TRUE(std::regex_search(checked.out, disk,
                                std::regex("expected disk .* and at most about ([0-9.]+) MB for the result")))
      << checked.out;
  const Outcome outcome = run({"--threads", "1"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  double bytes = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder / "out"))
    bytes += static_cast<double>(file.file_size());
  EXPECT_LE(bytes, 1e6 * std::stod(disk[1].str()));
  EXPECT_THAT(outcome.err, ContainsRegex("writing will take about [0-9.]+ s; the disk"));
  EXPECT_THAT(outcome.out,
              ContainsRegex("simulation [0-9.]+ s \\([0-9.e+]+ pings per second\\), writing [0-9.]+ s"));
  EXPECT_THAT(run({"--quiet", "--pictures", "none"}).err, Not(HasSubstr("writing")));
}

TEST_F(RunOutputs, ExpectsHoursAndMoreDiskThanThereIs) {
  write(scene(3));
  const std::string text = bytes_of(folder / "scene.toml");
  folder.write("scene.toml", replaced(text, "pings = 3\n", "pings = 900000\n"));
  const Outcome checked = run_program({"check", (folder / "scene.toml").string()});
  EXPECT_THAT(checked.out, ContainsRegex("then about [0-9.]+ hours for writing files"));
}

}  // namespace
}  // namespace tubefoot
