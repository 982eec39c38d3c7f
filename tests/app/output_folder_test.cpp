// SPDX-License-Identifier: GPL-3.0-or-later
// Tests result folders: a folder appears as a whole or not at all, and the program never touches files that
// tubefoot did not write.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct OutputFolders : testing::Test {
  TestFolder folder;
  const fs::path results = folder / "results";
  const std::set<std::string> input{"scene.toml", "thing.obj"};
  OutputFolders() {
    folder.write("scene.toml", small_scene);
    folder.write("thing.obj", tetrahedron);
  }

  Outcome run(const fs::path& output, const Surroundings& surroundings = {},
              const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"run", (folder / "scene.toml").string(), "-o", output.string(), "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words, surroundings);
  }
};

TEST_F(OutputFolders, HoldTheResultsAndNothingElseIsLeft) {
  ASSERT_EQ(run(results).exit_code, 0);
  EXPECT_EQ(names_below(results), (std::set<std::string>{".tubefoot-files", "echoes.nc", "stats.json",
                                                         "scene.png", "camera-0000.png", "camera-0000.exr"}));
  std::set<std::string> beside;
  for (const auto& entry : fs::directory_iterator(folder.path()))
    beside.insert(entry.path().filename().string());
  EXPECT_EQ(beside, (std::set<std::string>{"results", "scene.toml", "thing.obj"}));
}

TEST_F(OutputFolders, EarlierResultsAreReplacedWhole) {
  folder.write("scene.toml", std::string(small_scene) + "pings = 3\n");
  ASSERT_EQ(run(results).exit_code, 0);
  EXPECT_TRUE(fs::exists(results / "camera-0002.png"));
  folder.write("scene.toml", small_scene);
  ASSERT_EQ(run(results).exit_code, 0);
  EXPECT_TRUE(fs::exists(results / "camera-0000.png"));
  EXPECT_FALSE(fs::exists(results / "camera-0002.png"));
}

TEST_F(OutputFolders, MayBeEmptyNestedOrEndInASlash) {
  fs::create_directory(results);
  EXPECT_EQ(run(results).exit_code, 0);
  EXPECT_EQ(run(folder / "new/and/deep").exit_code, 0);
  EXPECT_TRUE(fs::exists(folder / "new/and/deep/echoes.nc"));
  EXPECT_EQ(run((folder / "slash").string() + "/").exit_code, 0);
  EXPECT_TRUE(fs::exists(folder / "slash/echoes.nc"));
}

TEST_F(OutputFolders, ThatAreFilesAreRefused) {
  folder.write("results", "mine");
  const Outcome outcome = run(results);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("exists and is not a folder"));
  EXPECT_EQ(bytes_of(results), "mine");
  EXPECT_EQ(run(results / "below").exit_code, 2);
}

TEST_F(OutputFolders, WithForeignFilesAreRefusedAndUntouched) {
  ASSERT_EQ(run(results).exit_code, 0);
  folder.write("results/notes.txt", "mine");
  const auto before = names_below(folder.path());
  const std::string echoes = bytes_of(results / "echoes.nc");
  const Outcome outcome = run(results);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("holds 'notes.txt', which tubefoot did not write"));
  EXPECT_EQ(names_below(folder.path()), before);
  EXPECT_TRUE(bytes_of(results / "echoes.nc") == echoes);
  EXPECT_EQ(bytes_of(results / "notes.txt"), "mine");
}

TEST_F(OutputFolders, EarlierResultsOutliveAFailedRun) {
  ASSERT_EQ(run(results).exit_code, 0);
  const auto before = names_below(folder.path());
  const std::string echoes = bytes_of(results / "echoes.nc");
  folder.write("thing.obj", "f 1 2 3\n");
  EXPECT_EQ(run(results).exit_code, 2);
  EXPECT_EQ(names_below(folder.path()), before);
  EXPECT_TRUE(bytes_of(results / "echoes.nc") == echoes);
}

TEST_F(OutputFolders, OfAFailedRunLeaveNoFoldersOnTheWay) {
  folder.write("thing.obj", "f 1 2 3\n");
  EXPECT_EQ(run(folder / "new/and/deep").exit_code, 2);
  EXPECT_EQ(names_below(folder.path()), input);
}

TEST_F(OutputFolders, ThatCannotBeWrittenAreRefused) {
  if (!nobody_can_run_program()) GTEST_SKIP() << "the program lies where only its owner may run it";
  Surroundings nobody;
  nobody.as_nobody = true;
  const Outcome outcome = run(results, nobody);  // the folder of the test belongs to another user
  if (geteuid() != 0 && outcome.exit_code == 0) {
    // The user is the same, so that the test removes the permission first.
    fs::remove_all(results);
    fs::permissions(folder.path(), fs::perms(0555));
    const Outcome refused = run(results);
    fs::permissions(folder.path(), fs::perms(0755));
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("cannot write into '" + folder.path().string() + "'"));
  } else {
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr("cannot write into '" + folder.path().string() + "'"));
  }
  EXPECT_EQ(names_below(folder.path()), input);
}

// The message names the file that first meets the full disk. The checkpoint is kept, and is enough to
// complete the run when there is space.
TEST_F(OutputFolders, FullDiskIsReportedAndLosesNothing) {
  folder.write("scene.toml", replaced(small_scene, "beams = 4", "beams = 1\nsamples = 8"));
  ASSERT_EQ(run(results).exit_code, 0);
  std::set<std::size_t> sizes{0};
  for (const auto& entry : fs::directory_iterator(results)) sizes.insert(entry.file_size() - 1);
  fs::remove_all(results);
  std::set<std::string> with_pings = input;
  with_pings.insert("results.partial");
  std::set<std::string> named;
  for (const std::size_t size : sizes) {
    SCOPED_TRACE(size);
    Surroundings full_disk;
    full_disk.largest_file_bytes = size;
    const Outcome outcome = run(results, full_disk);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
    // If another file failed, the advice after it names the .partial file.
    for (const char* file :
         {"echoes.nc", "camera-0000.png", "camera-0000.exr", "scene.png", "stats.json", "results.partial"})
      if (outcome.err.find(file) != std::string::npos) {
        named.insert(file);
        break;
      }
    if (fs::exists(folder / "results.partial")) {
      EXPECT_EQ(names_below(folder.path()), with_pings) << outcome.err;
      EXPECT_THAT(outcome.err, HasSubstr("1 of 1 pings are stored"));
      EXPECT_EQ(run(results, {}, {"--resume"}).exit_code, 0);
      fs::remove_all(results);
    }
    EXPECT_EQ(names_below(folder.path()), input) << outcome.err;
  }
  EXPECT_GE(named.size(), 2u) << testing::PrintToString(named);
}

}  // namespace
}  // namespace tubefoot
