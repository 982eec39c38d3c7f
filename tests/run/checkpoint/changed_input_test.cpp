// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that a run detects changes of its input files, for each kind of file. This includes files that are
// read with a named one and files that did not exist.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/world/long_run.hpp"
#include "run/partial_run.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::string_view scene = R"(title = "Of many files"
[[materials]]
name = "sand"
law = "table"
table_file = "law.csv"
[[materials]]
name = "rock"
[[terrain]]
kind = "raster"
file = "bed.asc"
material = "sand"
[terrain.material_map]
kind = "raster"
file = "map.asc"
classes = { 1 = "sand", 2 = "rock" }
[trajectory]
kind = "waypoints"
file = "track.csv"
[[sensors]]
name = "side"
kind = "sidescan"
depression_min_deg = 20
range_max_m = 10
samples = 200
ping_interval_s = 0.001
pings = 1000
)";

std::string grid(const char* cells) {
  return fmt::format("ncols 3\nnrows 3\nxllcorner -15\nyllcorner -15\ncellsize 10\n{}\n", cells);
}

struct ChangedInput : testing::Test {
  TestFolder folder;
  const fs::path results = folder / "results", partial = folder / "results.partial";
  std::map<std::string, std::string> files{
      {"law.csv", "10,-40\n90,-20\n"},
      {"bed.asc", grid("0 0 0\n0 0 0\n0 0 0")},
      {"bed.prj", "LOCAL_CS[\"none\",UNIT[\"metre\",1]]"},
      {"map.asc", grid("1 1 2\n1 2 2\n2 2 2")},
      {"track.csv",
       "time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg\n0,0,0,4,0,0,0\n10,1,0,4,0,0,0\n"}};
  ChangedInput() {
    folder.write("scene.toml", scene);
    for (const auto& [name, text] : files) folder.write(name, text);
  }
  Outcome run(const Surroundings& surroundings = {}) const {
    return run_program(
        {"run", (folder / "scene.toml").string(), "-o", results.string(), "--quiet", "--resume"},
        surroundings);
  }
};

TEST_F(ChangedInput, OfEveryKindIsNoticed) {
  files["map.prj"] = "";          // a companion that appears
  files["bed.asc.aux.xml"] = "";  // the same for another companion
  for (const auto& [name, good] : files) {
    SCOPED_TRACE(name);
    fs::remove(partial);
    Surroundings somebody_edits;
    somebody_edits.signal = 0;
    somebody_edits.interrupt_when = [&, file = name] {
      if (pings_kept(partial) == 0) return false;
      folder.write(file, files.at(file) + "\n");
      return true;
    };
    const Outcome outcome = run(somebody_edits);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("was changed during the run"), HasSubstr("restore it"),
                                   HasSubstr("1000 of 1000 pings are stored")));
    EXPECT_FALSE(fs::exists(results));
    if (name == files.begin()->first) {
      EXPECT_EQ(run().exit_code, 2) << "it is still another";
    }
    if (good.empty())
      fs::remove(folder / name);
    else
      folder.write(name, good);
  }
  EXPECT_EQ(run().exit_code, 0);
  EXPECT_FALSE(fs::exists(partial));
}

}  // namespace
}  // namespace tubefoot
