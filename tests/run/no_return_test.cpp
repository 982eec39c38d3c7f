// SPDX-License-Identifier: GPL-3.0-or-later
// Tests sensors that receive nothing. It compares the no-return check before a run with the results of
// runs, at random positions and directions with random range gates. It also compares the placement check of
// objects with their known positions.
#include "run/no_return.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "fixtures/scene_texts.hpp"
#include "fixtures/test_folder.hpp"
#include "run/placement.hpp"
#include "run/simulation.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using testing::Not;

std::unique_ptr<const Survey> survey_of(const std::string& text) {
  return open_survey(read_scene_text(text, "scene.toml"));
}

bool all_zero(const Recording& recording) {
  return std::ranges::all_of(recording.energy, [](double e) { return e == 0; });
}

/// A box and a sphere in the middle of a seabed of 20 x 20 m.
const std::string seabed =
    still_water() + lambert_material("sand", -27) + flat_terrain(20, 20) + ball_and_box();

TEST(NoReturn, IsExpectedExactlyWhereARunReceivesNothing) {
  const unsigned seed = 20261123;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  const auto between = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  std::size_t silent = 0, received = 0;
  for (int k = 0; k < 300; ++k) {
    const double nearest = between(0.5, 8);
    const std::string text =
        seabed +
        fixed_at(between(-14, 14), between(-14, 14), between(1.5, 8),
                 fmt::format("heading_deg = {}\npitch_deg = {}\n", between(-180, 180), between(-60, 10))) +
        fmt::format(
            "[[sensors]]\nname = \"eye\"\nkind = \"imaging\"\nbeams = 5\nhorizontal_deg = 10\nvertical_deg = "
            "{}\n"
            "range_min_m = {}\nrange_max_m = {}\nsamples = 20\n",
            between(1, 30), nearest, nearest + between(0.2, 6));
    SCOPED_TRACE(text);
    const auto survey = survey_of(text);
    const RunRequest request;
    SimulationStats stats;
    const std::vector<Recording> recordings = simulate(*survey, request, stats);
    const bool zero = all_zero(recordings.front());
    ++(zero ? silent : received);
    EXPECT_EQ(expected_no_returns(*survey, request).size(), zero ? 1U : 0U);
    EXPECT_EQ(met_no_returns(*survey, request, recordings).size(), zero ? 1U : 0U);
  }
  EXPECT_GT(silent, 20U);
  EXPECT_GT(received, 20U);
}

// One ping of thirty sees the seabed, so that there is no false alarm.
TEST(NoReturn, IsNotExpectedOfATrackThatReceivesSomethingOnce) {
  const auto track = [](double north_m) {
    return seabed +
           fmt::format(
               "[trajectory]\nkind = \"line\"\nstart_m = [0, {0}, 3]\nend_m = [0, {1}, 3]\nspeed_m_s = 10\n"
               "[[sensors]]\nname = \"side\"\nkind = \"sidescan\"\npings = 30\nping_interval_s = 1\n"
               "range_min_m = 1\nrange_max_m = 8\nsamples = 20\ndepression_min_deg = 30\nalong_track_deg = "
               "1\n",
               north_m, north_m + 290.5);
  };
  const RunRequest request;
  EXPECT_TRUE(expected_no_returns(*survey_of(track(-270)), request).empty());
  const auto beside = expected_no_returns(*survey_of(track(15)), request);
  ASSERT_EQ(beside.size(), 1U);
  EXPECT_THAT(beside.front().warning, HasSubstr("receives nothing at any ping: at ping 15"));
  EXPECT_THAT(beside.front().warning, HasSubstr("155 m outside of the terrain"));
}

// The check of direct visibility does not exclude echoes over a mirror.
TEST(NoReturn, IsNotExpectedUnderAMirror) {
  const std::string up =
      seabed + "[sea_surface]\nheight_m = 10\n[paths]\norder = 2\n" + fixed_at(0, 0, 3) +
      "[[sensors]]\nname = \"eye\"\nkind = \"imaging\"\nbeams = 4\nhorizontal_deg = 8\n"
      "vertical_deg = 20\ntilt_deg = -40\nrange_min_m = 1\nrange_max_m = 25\nsamples = 20\n";
  EXPECT_TRUE(expected_no_returns(*survey_of(up), {}).empty());
  EXPECT_EQ(expected_no_returns(
                *survey_of(replaced(up, "[sea_surface]\nheight_m = 10\n[paths]\norder = 2\n", "")), {})
                .size(),
            1U);
}

TEST(SeabedPlacement, IsWhereThingsWerePut) {
  // Cubes of a metre over a seabed at -7 m: height of their middle above the seabed, and the report.
  const std::vector<std::pair<double, std::string>> cubes{
      {-2, "buried: its top is 1.5 m below the seabed"},
      {-0.5 - 1e-3, "buried: its top is 0.001 m below the seabed"},
      {-0.25, "partly buried: from 0.75 m below the seabed to 0.25 m above"},
      {0.5, "on the seabed"},
      {0.505, "0.005 m above the seabed"},
      {2.75, "2.25 m above the seabed"}};
  std::string text = lambert_material("sand", -27) + flat_terrain(20, 20, "centre_m = [100, 0, -7]\n");
  for (std::size_t k = 0; k < cubes.size(); ++k)
    text += fmt::format("[[objects]]\nname = \"cube {}\"\nshape = \"box\"\nposition_m = [{}, 1.3, {}]\n", k,
                        95 + 2.0 * static_cast<double>(k), cubes[k].first - 7);
  text += fixed_at(100, 0, 0) + "[[sensors]]\nname = \"eye\"\nkind = \"imaging\"\ntilt_deg = 60\n";
  const std::vector<SeabedPlacement> found = placements(*survey_of(text));
  ASSERT_EQ(found.size(), cubes.size());
  for (std::size_t k = 0; k < cubes.size(); ++k) {
    EXPECT_EQ(found[k].words, cubes[k].second);
    EXPECT_EQ(found[k].warning.empty(), k >= 2) << found[k].warning;
  }
}

TEST(SeabedPlacement, CountsFromTheHighestTerrain) {
  const std::string deep = flat_terrain(20, 20, "name = \"deep\"\ncentre_m = [0, 0, -7]\n"),
                    shallow = flat_terrain(20, 20, "name = \"shallow\"\ncentre_m = [0, 0, -4]\n"),
                    rest = "[[objects]]\nname = \"cube\"\nshape = \"box\"\nposition_m = [1.1, 1.3, -1.5]\n" +
                           fixed_at(0, 0, 0) + "[[sensors]]\nname = \"eye\"\nkind = \"imaging\"\n";
  for (const std::string& terrains : {deep + shallow, shallow + deep}) {
    const auto found = placements(*survey_of(lambert_material("sand", -27) + terrains + rest));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].words, "2 m above the seabed");
  }
}

TEST(SeabedPlacement, ReportsObjectsMoreThanFourTimesAsWideAsTheTerrain) {
  const auto words = [](double east_m, double north_m) {
    const std::string box = fmt::format(
        "[[objects]]\nname = \"box\"\nshape = \"box\"\nsize_m = [{}, {}, 1]\nposition_m = [0.1, 0.2, 2]\n",
        east_m, north_m);
    return placements(*survey_of(lambert_material("sand", -27) + flat_terrain(20, 20) + box +
                                 fixed_at(0, 0, 9) + "[[sensors]]\nname = \"eye\"\nkind = \"imaging\"\n"))
        .at(0)
        .words;
  };
  EXPECT_EQ(words(80.4, 1), "4.02 times as wide as the terrain");
  EXPECT_EQ(words(1, 80.4), "4.02 times as wide as the terrain");
  EXPECT_THAT(words(1, 79.6), Not(HasSubstr("times as wide")));
}

TEST(RangeGate, IsReportedBeyondTwentyTimesTheFarthestPointOfAllPings) {
  // The track ends over the middle of the seabed, where its farthest corner is 15 m away. From the beginning
  // it is hypot(12, 10, 5) m away.
  const double farthest_m = std::sqrt(12.0 * 12 + 10 * 10 + 5 * 5);
  const auto warnings = [&](double times) {
    const std::string text =
        lambert_material("sand", -27) + flat_terrain(20, 20) +
        "[trajectory]\nkind = \"line\"\nstart_m = [2, 0, 5]\nend_m = [0, 0, 5]\n" +
        fmt::format(
            "[[sensors]]\nname = \"eye\"\nkind = \"imaging\"\nrange_min_m = 1\nrange_max_m = {}\n"
            "samples = 20\npings = 3\nping_interval_s = 0.1\n",
            times * farthest_m);
    return vast_windows(*survey_of(text));
  };
  EXPECT_TRUE(warnings(19.9).empty());
  ASSERT_EQ(warnings(20.1).size(), 1u);
  EXPECT_THAT(warnings(20.1)[0], HasSubstr("no point of the scene is farther away than 16.4 m"));
}

// A grid of 40 x 40 m at -5 m gives the same report in four forms. These are whole, by tiles, with relief
// for each transmission, and in stratified water.
TEST(NoReturn, IsExpectedOverEveryKindOfSurface) {
  const TestFolder folder;
  std::string grid = "ncols 41\nnrows 41\nxllcorner -20.5\nyllcorner -20.5\ncellsize 1\n";
  for (int row = 0; row < 41; ++row) {
    for (int column = 0; column < 41; ++column) grid += "-5 ";
    grid += '\n';
  }
  folder.write("grid.asc", grid);
  const auto survey = [&](const std::string& water, const std::string& relief, const std::string& more,
                          double tilt_deg, double range_m) {
    return open_survey(read_scene_text(
        water + lambert_material("sand", -27) + relief +
            "[[terrain]]\nkind = \"raster\"\nfile = \"grid.asc\"\n" + more +
            "[[objects]]\nname = \"box\"\nshape = \"box\"\nposition_m = [3, 3, -4.75]\n" +
            fixed_at(0.3, 0.2, 0) +
            fmt::format(
                "[[sensors]]\nname = \"eye\"\nkind = \"imaging\"\nbeams = 4\nhorizontal_deg = 8\n"
                "vertical_deg = 10\ntilt_deg = {}\nrange_min_m = {}\nrange_max_m = {}\nsamples = 20\n",
                tilt_deg, range_m, range_m + 10),
        folder / "scene.toml"));
  };
  const std::string even = still_water(),
                    layered =
                        "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = 0.5\n"
                        "profile_bottom_m = 50\n",
                    rough =
                        "[[materials.relief]]\nkind = \"fbm\"\nhurst = 0.5\nrms_height_m = 0.01\ntile_m = 8\n"
                        "resolution_m = 0.25\n";
  const RunRequest request;
  for (const auto& [water, relief, more] : std::vector<std::array<std::string, 3>>{
           {even, "", ""}, {even, "", "load = \"tiles\"\n"}, {layered, "", ""}, {even, rough, ""}}) {
    SCOPED_TRACE(water + relief + more);
    EXPECT_TRUE(expected_no_returns(*survey(water, relief, more, 40, 4), request).empty());
    const auto up = expected_no_returns(*survey(water, relief, more, -40, 4), request);
    ASSERT_EQ(up.size(), 1U);
    EXPECT_THAT(up.front().warning, HasSubstr("degrees up"));
    EXPECT_THAT(up.front().warning, HasSubstr(" m above the terrain"));
    const auto far = expected_no_returns(*survey(water, relief, more, 40, 40), request);
    ASSERT_EQ(far.size(), 1U);
    EXPECT_THAT(far.front().warning, HasSubstr("its range gate is 40 to 50 m"));
    const std::vector<SeabedPlacement> box = placements(*survey(water, relief, more, 40, 4));
    ASSERT_EQ(box.size(), 1U);
    EXPECT_THAT(box.front().words, HasSubstr("partly buried: from 0.2"));
  }
}

}  // namespace
}  // namespace tubefoot
