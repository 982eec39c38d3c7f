// SPDX-License-Identifier: GPL-3.0-or-later
// Tests shadow = "fresnel" of sensors: what changes and what does not, with patterns, labels, selections,
// terrains and moving objects. Tests the statements about uncertified energies.
#include "run/fresnel_borders.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "fixtures/netcdf_reader.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A wall of 1.5 m on a flat seabed, 9 m to port of a carrier that moves east. The sonar looks to port.
/// `rest` has keys of the sensor.
std::string wall_scene(const std::string& rest, const std::string& wall = "position_m = [0.3, 9, 0.75]\n") {
  return lambert_material("sand", -20) + flat_terrain(60, 60) +
         "[[objects]]\nname = \"wall\"\nshape = \"box\"\nmaterial = \"sand\"\nsize_m = [2, 0.2, 1.5]\n" +
         wall +
         "[trajectory]\nkind = \"line\"\nstart_m = [0, 0, 4]\nend_m = [0.5, 0, 4]\nspeed_m_s = 0.5\n"
         "[[sensors]]\nname = \"ahead\"\nkind = \"imaging\"\nyaw_deg = -90\nfrequency_khz = 200\ntilt_deg = "
         "20\nbeams = 20\n"
         "horizontal_deg = 30\nvertical_deg = 34\nrange_min_m = 8\nrange_max_m = 22\nsamples = 140\npings = "
         "2\n"
         "ping_interval_s = 0.2\n" +
         rest;
}

struct FresnelBorders : testing::Test {
  TestFolder folder;
  int runs = 0;
  std::filesystem::path output;

  NetcdfReader run(const std::string& scene, std::vector<std::string> options = {}) {
    const std::string file = folder.write(fmt::format("scene{}.toml", ++runs), scene).string();
    output = folder / fmt::format("out{}", runs);
    std::vector<std::string> words{"run", file, "-o", output.string(), "--quiet"};
    words.insert(words.end(), options.begin(), options.end());
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return NetcdfReader(output / "echoes.nc");
  }
  std::vector<double> energies(const std::string& scene, std::vector<std::string> options = {}) {
    return run(scene, std::move(options)).values("/", "energy");
  }
  static double sum(const std::vector<double>& values) { return std::reduce(values.begin(), values.end()); }
};

const std::string fresnel = "shadow = \"fresnel\"\n";

TEST_F(FresnelBorders, ChangeOnlyEnergiesNearTheShadow) {
  const std::vector<double> sharp = energies(wall_scene("shadow = \"sharp\"\n")),
                            weighted = energies(wall_scene(fresnel));
  ASSERT_EQ(sharp.size(), weighted.size());
  std::size_t filled = 0, brighter = 0, unchanged = 0;
  for (std::size_t k = 0; k < sharp.size(); ++k) {
    ASSERT_GE(weighted[k], -1e-12 * sharp.front());
    if (sharp[k] == 0 && weighted[k] > 0) ++filled;
    if (weighted[k] > 1.3 * sharp[k]) ++brighter;
    if (weighted[k] == sharp[k]) ++unchanged;
    // Ranges up to the top of the wall lie in front of all shadow borders.
    if (k % 140 < 5) {
      EXPECT_EQ(weighted[k], sharp[k]);
    }
  }
  EXPECT_GT(filled, 200u);
  EXPECT_GT(brighter, 50u);
  EXPECT_GT(unchanged, 2000u);
  // The energy that leaves the insonified side appears in the shadow, up to the truncation of the weights.
  EXPECT_NEAR(sum(weighted), sum(sharp), 0.01 * sum(sharp));
}

TEST_F(FresnelBorders, AreAbsentByDefaultAndWithoutShadows) {
  const NetcdfReader by_default = run(wall_scene(""));
  const std::vector<double> sharp = energies(wall_scene("shadow = \"sharp\"\n"));
  EXPECT_EQ(by_default.values("/", "energy"), sharp);
  const std::string far = "position_m = [0.3, 29, 0.75]\n";
  EXPECT_EQ(energies(wall_scene("", far)), energies(wall_scene(fresnel, far)));
}

TEST_F(FresnelBorders, AreStatedAsUncertified) {
  const std::string statement(fresnel_statement);
  for (const bool weighted : {true, false}) {
    const std::string scene = wall_scene(weighted ? fresnel : "");
    const NetcdfReader file = run(scene);
    const auto stats = nlohmann::json::parse(std::ifstream(output / "stats.json"));
    const Outcome check = run_program({"check", folder.write("checked.toml", scene).string()});
    ASSERT_EQ(check.exit_code, 0) << check.err;
    if (weighted) {
      EXPECT_EQ(file.text("/", "shadow_borders"), statement);
      EXPECT_EQ(stats.at("shadow_borders").at("ahead"), statement);
      EXPECT_THAT(check.out, HasSubstr("shadow borders: " + statement));
    } else {
      EXPECT_ANY_THROW(file.text("/", "shadow_borders"));
      EXPECT_FALSE(stats.contains("shadow_borders"));
      EXPECT_THAT(check.out, Not(HasSubstr(statement)));
    }
  }
}

TEST_F(FresnelBorders, HaveNoReference) {
  const std::string file = folder.write("scene.toml", wall_scene(fresnel)).string();
  const Outcome outcome = run_program({"run", file, "-o", (folder / "out").string(), "--reference"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err,
              HasSubstr("diffraction at shadow borders has no certified bound: set shadow = \"sharp\""));
}

TEST_F(FresnelBorders, RejectMergedFacets) {
  const std::string file = folder.write("scene.toml", wall_scene(fresnel)).string();
  const Outcome outcome = run_program({"run", file, "-o", (folder / "out").string(), "--coarsen", "0.5"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("merged facets displace silhouette edges"));
}

TEST_F(FresnelBorders, DoNotDependOnThreadsAndSelections) {
  const std::string scene = wall_scene(fresnel);
  const std::vector<double> all = energies(scene, {"--threads", "2"});
  EXPECT_EQ(energies(scene, {"--threads", "1"}), all);
  const std::vector<double> some = energies(scene, {"--sensor", "ahead", "--pings", "1", "--beams", "6:8"});
  ASSERT_EQ(some.size(), 3 * 140u);
  for (std::size_t k = 0; k < some.size(); ++k) EXPECT_EQ(some[k], all[(20 + 6) * 140 + k]) << k;
}

// The patterns of wide elements hardly change energies within the beams.
TEST_F(FresnelBorders, HaveBeamPatterns) {
  const std::string pattern = "receive_pattern = \"gaussian\"\nreceive_beam_width_deg = 1.5\n";
  const std::vector<double> sharp = energies(wall_scene(pattern)),
                            weighted = energies(wall_scene(pattern + fresnel)),
                            ideal_sharp = energies(wall_scene("")), ideal = energies(wall_scene(fresnel));
  EXPECT_NEAR((sum(weighted) - sum(sharp)) / sum(sharp), (sum(ideal) - sum(ideal_sharp)) / sum(ideal_sharp),
              2e-3);
  double change = 0;
  for (std::size_t k = 0; k < sharp.size(); ++k) {
    ASSERT_GE(weighted[k], -1e-6 * sum(sharp) / double(sharp.size()));
    change += std::abs(weighted[k] - sharp[k]);
  }
  EXPECT_GT(change, 0.005 * sum(sharp));
}

TEST_F(FresnelBorders, HaveLabels) {
  const NetcdfReader file = run(wall_scene(fresnel), {"--labels"});
  const std::vector<double> energy = file.values("/", "energy");
  EXPECT_EQ(energy, energies(wall_scene(fresnel)));
  const std::vector<double> shares = file.values("/", "object_share");
  std::size_t with = 0;
  for (std::size_t cell = 0; cell < energy.size(); ++cell) {
    if (energy[cell] <= 0) continue;
    const std::size_t ping = cell / (20 * 140), own = cell % (20 * 140);
    double total = 0;
    for (std::size_t object = 0; object < 2; ++object) total += shares[(ping * 2 + object) * 20 * 140 + own];
    EXPECT_NEAR(total, 1, 1e-5);
    ++with;
  }
  EXPECT_GT(with, 3000u);
}

// A moving wall at a place has the energies of a wall at rest at this place.
TEST_F(FresnelBorders, FollowMovingObjects) {
  const std::string track =
      "[[trajectories]]\nname = \"sonar\"\nkind = \"fixed\"\nposition_m = [0, 0, 4]\n"
      "[[trajectories]]\nname = \"crane\"\nkind = \"fixed\"\nposition_m = [0.3, 9, 0.75]\n";
  const auto with = [&](const std::string& wall) {
    std::string scene = wall_scene("trajectory = \"sonar\"\n" + fresnel, wall);
    const std::size_t begin = scene.find("[trajectory]"), end = scene.find("[[sensors]]");
    return scene.replace(begin, end - begin, track);
  };
  const std::vector<double> moving = energies(with("trajectory = \"crane\"\n")),
                            at_rest = energies(with("position_m = [0.3, 9, 0.75]\n"));
  ASSERT_EQ(moving.size(), at_rest.size());
  // Vertices have other numbers, so that polygons may be divided in another order.
  for (std::size_t k = 0; k < moving.size(); ++k)
    EXPECT_NEAR(moving[k], at_rest[k], 5e-3 * at_rest[k] + 1e-8 * sum(at_rest)) << k;
}

// A ridge of a terrain shades the terrain behind it, as a screen at its crest does.
TEST_F(FresnelBorders, OfATerrainFillItsOwnShadow) {
  std::string raster = "ncols 41\nnrows 121\nxllcorner -10\nyllcorner -5\ncellsize 0.5\n";
  for (int row = 120; row >= 0; --row) {
    const double y = -5 + 0.5 * (row + 0.5);
    for (int column = 0; column < 41; ++column)
      raster += fmt::format("{:.3f} ", std::max(0.0, 1.5 - 0.9 * std::abs(y - 9.25)));
    raster += '\n';
  }
  folder.write("ridge.asc", raster);
  const auto scene = [&](const std::string& rest) {
    std::string text = wall_scene(rest);
    const std::size_t begin = text.find("[[terrain]]"), end = text.find("[trajectory]");
    return text.replace(begin, end - begin,
                        "[[terrain]]\nkind = \"raster\"\nfile = \"ridge.asc\"\nmaterial = \"sand\"\n");
  };
  const std::vector<double> sharp = energies(scene("")), weighted = energies(scene(fresnel));
  std::size_t filled = 0;
  for (std::size_t k = 0; k < sharp.size(); ++k)
    if (sharp[k] == 0 && weighted[k] > 0) ++filled;
  EXPECT_GT(filled, 100u);
  EXPECT_NEAR(sum(weighted), sum(sharp), 0.02 * sum(sharp));
}

}  // namespace
}  // namespace tubefoot
