// SPDX-License-Identifier: GPL-3.0-or-later
// Tests sensor positions and minimum beam widths. `check` and `run` reject sensors with wrong or no
// visibility, and report the position and a remedy.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fixtures/program.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string placed_scene(const std::string& position,
                         const std::string& sensor = "beams = 2\nhorizontal_deg = 2\n",
                         const std::string& more = "") {
  return R"([water]
sound_speed_m_s = 1500
absorption_db_per_km = 0
[[materials]]
name = "sand"
[[terrain]]
kind = "flat"
width_m = 20
length_m = 40
cell_m = 10
[[objects]]
name = "crate"
shape = "box"
size_m = [2, 2, 2]
position_m = [5, 5, 1]
[trajectory]
kind = "fixed"
position_m = )" +
         position + "\n" + more + R"([[sensors]]
name = "sonar"
kind = "imaging"
vertical_deg = 20
tilt_deg = 20
range_max_m = 15
)" + sensor;
}

void expect_refused(const std::string& text, const std::vector<std::string>& words) {
  const TestFolder folder;
  const std::string file = folder.write("scene.toml", text).string(), out = (folder / "out").string();
  for (const auto& command :
       std::vector<std::vector<std::string>>{{"check", file}, {"run", file, "-o", out}, {"audit", file}}) {
    const Outcome outcome = run_program(command);
    EXPECT_EQ(outcome.exit_code, 2) << command[0];
    EXPECT_THAT(outcome.err, HasSubstr("scene.toml:")) << command[0];
    for (const std::string& word : words) EXPECT_THAT(outcome.err, HasSubstr(word)) << command[0];
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(SensorPlace, OnASeabedAnEdgeOrAVertexIsRefused) {
  expect_refused(placed_scene("[1, 3, 0]"),
                 {"lies exactly on a facet of 'terrain' at ping 0", "by a millimetre or more"});
  expect_refused(placed_scene("[0, 3, 0]"), {"lies exactly on an edge of 'terrain'"});
  expect_refused(placed_scene("[0, 0, 0]"), {"lies exactly on a vertex of 'terrain'"});
}

TEST(SensorPlace, OnAnObjectIsRefused) {
  expect_refused(placed_scene("[4.5, 4, 1.25]"), {"lies exactly on a facet of 'crate'"});
  expect_refused(placed_scene("[4, 4, 0.5]"), {"lies exactly on an edge of 'crate'"});
  expect_refused(placed_scene("[4, 4, 2]"), {"lies exactly on a vertex of 'crate'"});
}

TEST(SensorPlace, OnTheWayIsReportedWithItsPing) {
  // The track goes from above the seabed down to it. The fourth ping is on the seabed.
  expect_refused(
      "[[materials]]\nname = \"sand\"\n[[terrain]]\nkind = \"flat\"\nwidth_m = 20\nlength_m = 40\n"
      "[trajectory]\nkind = \"line\"\nstart_m = [1, -3, 3]\nend_m = [1, 5, -5]\nspeed_m_s = "
      "1.4142135623730951\n"
      "[[sensors]]\nname = \"sonar\"\nkind = \"imaging\"\npings = 4\nping_interval_s = 1\nrange_max_m = 9\n",
      {"at ping 3"});
}

TEST(SensorPlace, InThePlaneOfAFacetButNotOnItIsAPlaceLikeAnother) {
  const TestFolder folder;
  // Next to the seabed, at the same height.
  const Outcome outcome =
      run_program({"check", folder.write("scene.toml", placed_scene("[15, 3, 0]")).string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST(NarrowBeams, BelowWhatDirectionsTellApartAreRefused) {
  for (const char* sensor : {"beams = 4\nhorizontal_deg = 4e-7\n", "beams = 4\nhorizontal_deg = 3.9e-5\n",
                             "beams = 4096\nhorizontal_deg = 0.04\n"})
    expect_refused(placed_scene("[0, 0, 3]", sensor),
                   {"degrees, but the resolution of directions is 6e-8 degrees", "at least 1e-05 degrees",
                    "fewer beams"});
  std::string thin = placed_scene("[0, 0, 3]");
  thin.replace(thin.find("vertical_deg = 20"), 17, "vertical_deg = 1e-7");
  expect_refused(thin, {"at least 1e-05 degrees"});
}

TEST(NarrowBeams, AreWorthWhatTheWarningSays) {
  // The energy of a seabed in a sector is proportional to its width: the error is at most a hundredth at
  // the limit.
  const TestFolder folder;
  const auto total = [&](const std::string& name, double width_deg, bool told) {
    const std::string text =
        placed_scene("[0, 0, 3]", fmt::format("beams = 1\nhorizontal_deg = {}\n", width_deg));
    const Outcome outcome =
        run_program({"run", folder.write(name + ".toml", text).string(), "-o", (folder / name).string()});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    if (told)
      EXPECT_THAT(outcome.err, HasSubstr("rounding of directions"));
    else
      EXPECT_THAT(outcome.err, Not(HasSubstr("rounding of directions")));
    return read_echoes(folder / name / "echoes.nc").total() / width_deg;
  };
  const double wide = total("wide", 0.1, false);
  EXPECT_NEAR(total("narrow", 1e-5, true) / wide, 1, 0.01);
  EXPECT_NEAR(total("middling", 1e-3, false) / wide, 1, 1e-4);
}

}  // namespace
}  // namespace tubefoot
