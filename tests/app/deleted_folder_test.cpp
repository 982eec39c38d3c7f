// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a current folder that another process has deleted. Absolute paths still work, and relative paths
// give errors in the program's own messages.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

struct DeletedFolder : testing::Test {
  TestFolder folder;
  DeletedFolder() {
    folder.write("scene.toml", replaced(small_scene, "beams = 4", "beams = 2\nsamples = 64"));
    folder.write("thing.obj", tetrahedron);
  }
  std::string at(const std::string& name) const { return (folder / name).string(); }
  Outcome run_in_deleted_folder(const std::vector<std::string>& arguments) const {
    Surroundings surroundings;
    surroundings.before = {"/bin/sh", "-c",
                           "mkdir '" + at("gone") + "' && cd '" + at("gone") + "' && rmdir '" + at("gone") +
                               "' && exec \"$0\" \"$@\""};
    return run_program(arguments, surroundings);
  }
};

TEST_F(DeletedFolder, IsNamedByEveryCommandThatWritesBesideIt) {
  ASSERT_EQ(run_program({"run", at("scene.toml"), "-o", at("out"), "--quiet"}).exit_code, 0);
  ASSERT_EQ(run_program({"export", at("scene.toml"), "--to", "sdf", "-o", at("world")}).exit_code, 0);
  const std::string scene = at("scene.toml"), echoes = at("out/echoes.nc");
  const std::vector<std::vector<std::string>> commands{
      {"run", scene, "-o", "here"},
      {"run", scene, "-o", "here", "--shard", "1/2"},
      {"join", scene, "-o", "here"},
      {"footprints", scene, "--sensor", "camera", "-o", "here.csv"},
      {"coverage", scene, "-o", "here.csv"},
      {"strength", at("thing.obj"), "--frequencies", "5kHz", "-o", "here.csv"},
      {"view", scene, "-o", "here.html"},
      {"refine", scene, "-o", "here.ply"},
      {"export", scene, "--to", "gltf", "-o", "here"},
      {"import-scene", at("world/scene.sdf"), "-o", "here"},
      {"compare", echoes, echoes, "--json", "here.json"},
      {"compare", echoes, echoes, "--png", "here.png"},
      {"chart", scene, "-o", "here"},
      {"suite", "-o", "here"},
      {"check", scene, "--png", "here.png"}};
  for (const std::vector<std::string>& command : commands) {
    SCOPED_TRACE(testing::PrintToString(command));
    const Outcome outcome = run_in_deleted_folder(command);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("'here"));
    EXPECT_THAT(
        outcome.err,
        HasSubstr("the current folder has been deleted, so the relative name cannot be resolved; go to "
                  "another folder (cd), or give names that begin with '/'"));
    EXPECT_THAT(outcome.err, Not(HasSubstr("filesystem error")));
  }
}

TEST_F(DeletedFolder, IsNoReasonForALibrarysWordsAboutFilesThatAreRead) {
  const std::vector<std::vector<std::string>> commands{
      {"run", "scene.toml", "-o", at("out")},
      {"check", "scene.toml"},
      {"audit", "scene.toml"},
      {"advise", "scene.toml", "--tolerance", "1e-3"},
      {"footprints", "scene.toml", "--sensor", "camera", "-o", at("f.csv")},
      {"coverage", "scene.toml", "-o", at("c.csv")},
      {"strength", "thing.obj", "--frequencies", "5kHz", "-o", at("s.csv")},
      {"view", "scene.toml", "-o", at("v.html")},
      {"refine", "scene.toml", "-o", at("r.ply")},
      {"export", "scene.toml", "--to", "sdf", "-o", at("sdf")},
      {"import-scene", "world.sdf", "-o", at("w")},
      {"compare", "a.nc", "b.nc"},
      {"import", "image.png", "--like", "a.nc", "--scale", "8bit", "-o", at("i.nc")},
      {"chart", "scene.toml", "-o", at("chart")}};
  for (const std::vector<std::string>& command : commands) {
    SCOPED_TRACE(testing::PrintToString(command));
    const Outcome outcome = run_in_deleted_folder(command);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, AnyOf(HasSubstr(command[1]), HasSubstr("a.nc")));
    EXPECT_THAT(outcome.err, Not(HasSubstr("filesystem error")));
  }
}

TEST_F(DeletedFolder, DoesNotMatterToNamesFromTheRoot) {
  const Outcome outcome = run_in_deleted_folder({"run", at("scene.toml"), "-o", at("out"), "--quiet"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  for (const char* option : {"--help", "--version"}) EXPECT_EQ(run_in_deleted_folder({option}).exit_code, 0);
  EXPECT_EQ(run_in_deleted_folder({"compare", at("out/echoes.nc"), at("out/echoes.nc")}).exit_code, 0);
}

}  // namespace
}  // namespace tubefoot
