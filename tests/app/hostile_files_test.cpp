// SPDX-License-Identifier: GPL-3.0-or-later
// Tests names in a scene file that lead elsewhere, and names that are not regular files. The program
// reports or rejects them, and never waits for them.
#include <fmt/format.h>
#include <sys/stat.h>

#include "fixtures/hostile.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string naming(const std::string& file) { return replaced(small_scene, "thing.obj", file); }

constexpr std::string_view grid = "ncols 2\nnrows 2\nxllcorner -5\nyllcorner -5\ncellsize 10\n0 0\n0 0\n";

std::string with_raster_file(const std::string& file = "grid.asc") {
  return replaced(small_scene, "kind = \"flat\"\nwidth_m = 20\nlength_m = 30",
                  "kind = \"raster\"\nfile = \"" + file + "\"");
}

TEST_F(Hostile, NamesThatAreNoFiles) {
  const std::string place = "scene.toml:11:8: 'file'";
  mkfifo((folder / "pipe.obj").c_str(), 0600);
  expect_refused(naming("pipe.obj"), {place, "is a special file, expected a regular file"});
  expect_refused(naming("/dev/zero"), {place, "is a special file"});
  fs::create_symlink("/dev/zero", folder / "zero.obj");
  expect_refused(naming("zero.obj"), {place, "is a special file"});
  expect_refused(naming("thing.obj\\u0000.txt"), {place, "control characters"});
  expect_refused(naming(std::string(60'000, 'x')), {place, "cannot access '", "xxx [", " characters] xxx"});
  expect_refused(naming(std::string(1'000'000, 'x')), {place, "has 1000000 bytes, expected at most 65536"});
}

TEST_F(Hostile, SceneFilesThatAreNoFiles) {
  mkfifo((folder / "pipe.toml").c_str(), 0600);
  for (const std::string& name : {(folder / "pipe.toml").string(), std::string("/dev/zero")}) {
    const Outcome outcome = run({"check", name});
    expect_harmless(outcome);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("is a special file, expected a scene file"));
  }
}

// Readers of rasters and maps also open files next to a file.
TEST_F(Hostile, PipesBesideAFile) {
  folder.write("grid.asc", grid);
  for (const char* name : {"grid.PRJ", "grid.asc.aux.xml", "grid.asc.msk"}) {
    SCOPED_TRACE(name);
    mkfifo((folder / name).c_str(), 0600);
    expect_refused(
        with_raster_file(),
        {"scene.toml:6:8: ", name,
         ": is a special file, but its name is that of a companion file of 'grid.asc': move it away"});
    fs::remove(folder / name);
  }
  // not a format that the program reads, so that it is not opened
  mkfifo((folder / "grid.aux").c_str(), 0600);
  fs::create_directory(folder / "grid.prj");
  EXPECT_EQ(check(with_raster_file()).exit_code, 0);
}

TEST_F(Hostile, NamesThatLeaveTheFolderAreReported) {
  TestFolder elsewhere;
  elsewhere.write("other.obj", tetrahedron);
  elsewhere.write("grid.prj", "LOCAL_CS[\"none\"]");
  folder.write("grid.asc", grid);
  fs::create_symlink(elsewhere / "other.obj", folder / "linked.obj");
  fs::create_symlink(elsewhere / "grid.prj", folder / "grid.prj");
  const fs::path up = fs::path("..") / elsewhere.path().filename() / "other.obj";
  std::string scene = with_raster_file();
  for (const std::string& file : {up.string(), (elsewhere / "other.obj").string(), std::string("linked.obj")})
    scene += fmt::format("[[objects]]\nname = \"to {}\"\nshape = \"mesh\"\nfile = \"{}\"\n", file, file);
  const Outcome outcome = check(scene);
  expect_harmless(outcome);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string real = fs::canonical(elsewhere / "other.obj").string();
  for (const std::string& file : {up.string(), (elsewhere / "other.obj").string(), std::string("linked.obj")})
    EXPECT_THAT(outcome.err,
                HasSubstr(fmt::format("\"{}\" lies outside of the scene's folder, at '{}'", file, real)));
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr("scene.toml:6:8: 'grid.prj', which belongs to \"grid.asc\", lies outside"),
                    Not(HasSubstr("\"thing.obj\" lies outside"))));
}

// A message quotes the input, and a terminal must not obey the quoted text.
TEST_F(Hostile, MessagesHoldNoControlCharacters) {
  folder.write("track.csv",
               "time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg\n\x1b[2J\x07,0,0,0,0,0,0\n");
  const Outcome outcome = check(replaced(small_scene, "kind = \"fixed\"\nposition_m = [0, 0, 2]",
                                         "kind = \"waypoints\"\nfile = \"track.csv\""));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr("track.csv:2"), HasSubstr("\\x1b[2J\\x07"), Not(HasSubstr("\x1b"))));
}

}  // namespace
}  // namespace tubefoot
