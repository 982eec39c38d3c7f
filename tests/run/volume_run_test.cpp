// SPDX-License-Identifier: GPL-3.0-or-later
// Tests volume reverberation in whole runs: closed forms over a flat seabed, shadows, engines, layers,
// stratified water, separate receivers, motion, certified bounds and messages.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/test_folder.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

/// A fan to the side, 10 m above a seabed. Its beams are 1 degree wide along the track.
std::string fan_scene(const std::string& water, const std::string& sensor = {},
                      const std::string& more = {}) {
  return "[[materials]]\nname = \"sand\"\nlambert_db = -30\n" + more +
         "[[terrain]]\nkind = \"flat\"\nmaterial = \"sand\"\nwidth_m = 400\nlength_m = 400\n"
         "[trajectory]\nkind = \"fixed\"\nposition_m = [0, 0, 10]\n"
         "[[sensors]]\nname = \"fan\"\nkind = \"multibeam\"\nbeams = 6\nswath_deg = 120\nbeam_across_deg = "
         "20\n"
         "along_track_deg = 1\nrange_min_m = 2\nrange_max_m = 32\nsamples = 60\n" +
         sensor + "[water]\n" + water;
}
const std::string still = "sound_speed_m_s = 1500\nabsorption_db_per_km = 50\n";

/// Energies with and without scattering of the water, subtracted.
std::vector<double> reverberation(const TestFolder& folder, const std::string& scattering,
                                  const std::string& sensor = {}, const std::string& more = {},
                                  const std::vector<std::string>& arguments = {}) {
  const Echoes with = echoes_in(folder, fan_scene(still + scattering, sensor, more), arguments),
               without = echoes_in(folder, fan_scene(still, sensor, more), arguments);
  std::vector<double> difference(with.energy.size());
  for (std::size_t k = 0; k < difference.size(); ++k) difference[k] = with.energy[k] - without.energy[k];
  return difference;
}

struct VolumeRun : testing::Test {
  TestFolder folder;
};

TEST_F(VolumeRun, WaterAboveTheSeabedHasTheClosedForm) {
  const std::vector<double> volume = reverberation(folder, "volume_scattering_db = -60\n");
  const double beta = 0.05 * std::log(10) / 10, degree = std::numbers::pi / 180;
  // The centres of the beams are 24 degrees apart, and the beams 20 degrees wide. Seen from the apex, a beam
  // has the same width along the track at each of its angles.
  for (std::size_t beam = 0; beam < 6; ++beam)
    for (std::size_t k = 0; k < 60; ++k) {
      const double inner = 24 * std::abs(double(beam) - 2.5) - 10, outer = inner + 20;
      double expected = 0;
      for (int i = 0; i < 100; ++i) {
        const double r = 2 + 0.5 * (double(k) + (i + 0.5) / 100);
        const double hidden = r > 10 ? std::acos(10 / r) * 180 / std::numbers::pi : 0;  // nadir angles below
        const double from = std::max(inner, hidden);
        if (from >= outer) continue;
        expected += 1e-6 * degree * degree * (outer - from) / (r * r) * std::exp(-2 * beta * r) * 0.005;
      }
      EXPECT_NEAR(volume[beam * 60 + k], expected, 0.02 * expected + 1e-13)
          << "beam " << beam << ", bin " << k;
    }
}

TEST_F(VolumeRun, WaterBehindAWallReturnsNothing) {
  const std::string wall =
      "[[objects]]\nname = \"wall\"\nshape = \"box\"\nmaterial = \"sand\"\nsize_m = [1, 60, 30]\n"
      "position_m = [8, 0, 10]\n";
  const std::vector<double> free = reverberation(folder, "volume_scattering_db = -60\n"),
                            behind = reverberation(folder, "volume_scattering_db = -60\n", {}, wall);
  double beside = 0;
  for (std::size_t k = 0; k < 60; ++k) {
    const double range = 2 + 0.5 * double(k);
    // The outermost beam of one side meets the wall at 7.5 m to 11.7 m.
    const double other = std::max(behind[k], behind[5 * 60 + k]),
                 own = std::min(behind[k], behind[5 * 60 + k]);
    if (range + 0.5 < 7.5) {
      EXPECT_DOUBLE_EQ(own, free[k]);
    }
    if (range > 11.7) {
      EXPECT_EQ(own, 0);
      beside += other;
    }
  }
  EXPECT_GT(beside, 0);
}

TEST_F(VolumeRun, AllEnginesAndBinningsHaveTheSameReverberation) {
  const std::string key = "volume_scattering_db = -60\n";
  const std::vector<double> tubes = reverberation(folder, key);
  const double largest = *std::ranges::max_element(tubes);
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--engine", "ray"},
                                                    {"--binning", "centroid"},
                                                    {"--arithmetic", "rational"}}) {
    const std::vector<double> other = reverberation(folder, key, {}, {}, arguments);
    for (std::size_t k = 0; k < tubes.size(); ++k)
      EXPECT_NEAR(other[k], tubes[k], 1e-9 * largest) << arguments[1] << ", bin " << k;
  }
}

TEST_F(VolumeRun, LayersOfAFileAddUp) {
  const auto of = [&](const char* rows) {
    folder.write("layers.csv", std::string("depth_m,volume_scattering_db\n") + rows);
    return reverberation(folder, "volume_scattering_file = \"layers.csv\"\nsurface_height_m = 12\n");
  };
  const std::vector<double> upper = of("0,-60\n6,-999\n"), lower = of("0,-999\n6,-50\n"),
                            both = of("0,-60\n6,-50\n");
  const double largest = *std::ranges::max_element(both);
  for (std::size_t k = 0; k < both.size(); ++k)
    EXPECT_NEAR(upper[k] + lower[k], both[k], 1e-12 * largest) << "bin " << k;
  // The apex is 2 m below the surface, so the lower layer begins 4 m below the apex.
  EXPECT_NEAR(lower[2 * 60 + 3], 0, 1e-12 * largest);
  EXPECT_GT(lower[2 * 60 + 5], 0.01 * *std::ranges::max_element(lower));
}

TEST_F(VolumeRun, ProfileFileMayContainTheLayers) {
  folder.write("both.csv",
               "depth_m,sound_speed_m_s,volume_scattering_db\n0,1500,-60\n6,1490,-50\n40,1480,-50\n");
  folder.write("profile.csv", "depth_m,sound_speed_m_s\n0,1500\n6,1490\n40,1480\n");
  folder.write("layers.csv", "depth_m,volume_scattering_db\n0,-60\n6,-50\n");
  const auto energy = [&](const char* profile, const char* layers) {
    return echoes_in(folder, fan_scene(fmt::format(
                                 "profile = \"table\"\nprofile_file = \"{}\"\nsurface_height_m = 12\n"
                                 "volume_scattering_file = \"{}\"\n",
                                 profile, layers)))
        .energy;
  };
  EXPECT_EQ(energy("both.csv", "both.csv"), energy("profile.csv", "layers.csv"));
}

TEST_F(VolumeRun, WeakGradientAndMotionApproachTheCaseAtRestInIsovelocityWater) {
  const std::string key = "volume_scattering_db = -60\n";
  const std::vector<double> rest = reverberation(folder, key);
  folder.write("still.csv", "depth_m,sound_speed_m_s\n0,1500\n50,1500.0001\n");
  const std::string stratified =
      "profile = \"table\"\nprofile_file = \"still.csv\"\nsurface_height_m = 20\n"
      "absorption_db_per_km = 50\n";
  const Echoes with = echoes_in(folder, fan_scene(stratified + key)),
               without = echoes_in(folder, fan_scene(stratified));
  folder.write("track.csv",
               "time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg\n"
               "0,0,0,10,0,0,0\n1,0,0,10,0,0,0.001\n");
  const auto moved = [&](const std::string& scattering) {
    return echoes_in(folder, replaced(fan_scene(still + scattering, "stop_and_hop = false\n"),
                                      "kind = \"fixed\"\nposition_m = [0, 0, 10]",
                                      "kind = \"waypoints\"\nfile = \"track.csv\""));
  };
  const Echoes moving = moved(key), moving_without = moved("");
  const double largest = *std::ranges::max_element(rest);
  for (std::size_t k = 0; k < rest.size(); ++k) {
    EXPECT_NEAR(with.energy[k] - without.energy[k], rest[k], 0.01 * rest[k] + 1e-4 * largest) << "bin " << k;
    EXPECT_NEAR(moving.energy[k] - moving_without.energy[k], rest[k], 0.02 * rest[k] + 1e-3 * largest)
        << "bin " << k;
  }
}

TEST_F(VolumeRun, DividedRecordsReceiveAllOfTheWater) {
  // At 20 degrees per second the record has many intervals. The sum over beams before the seabed is that at
  // rest, because the fan is uniform.
  folder.write("track.csv",
               "time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg\n"
               "0,0,0,10,0,0,-1\n0.1,0,0,10,0,0,1\n");
  const auto run = [&](const std::string& scattering) {
    return echoes_in(
        folder,
        replaced(fan_scene(still + scattering, "stop_and_hop = false\nmotion_step_beams = 0.005\n"),
                 "kind = \"fixed\"\nposition_m = [0, 0, 10]", "kind = \"waypoints\"\nfile = \"track.csv\""));
  };
  const Echoes with = run("volume_scattering_db = -60\n"), without = run("");
  const std::vector<double> rest = reverberation(folder, "volume_scattering_db = -60\n");
  for (std::size_t k = 0; k < 15; ++k) {
    double moving = 0, at_rest = 0;
    for (std::size_t beam = 0; beam < 6; ++beam) {
      moving += with.energy[beam * 60 + k] - without.energy[beam * 60 + k];
      at_rest += rest[beam * 60 + k];
    }
    EXPECT_NEAR(moving, at_rest, 0.02 * at_rest) << "bin " << k;
  }
}

TEST_F(VolumeRun, ReferenceHasBoundsThatContainTheOrdinaryResult) {
  folder.write("layers.csv", "depth_m,volume_scattering_db\n0,-60\n6,-50\n");
  const std::string scene =
      fan_scene(still + "volume_scattering_file = \"layers.csv\"\nsurface_height_m = 12\n");
  const Echoes ordinary = echoes_in(folder, scene),
               certified = echoes_in(folder, scene, {"--reference", "--tolerance", "1e-7"});
  ASSERT_EQ(certified.energy_bound.size(), ordinary.energy.size());
  const double largest = *std::ranges::max_element(ordinary.energy);
  for (std::size_t k = 0; k < ordinary.energy.size(); ++k) {
    EXPECT_NEAR(ordinary.energy[k], certified.energy[k],
                certified.energy_bound[k] + 1e-10 * ordinary.energy[k] + 1e-15 * largest)
        << "bin " << k;
    EXPECT_LE(certified.energy_bound[k], 1.1e-7 * std::max(certified.energy[k], 1e-6 * largest));
  }
}

TEST_F(VolumeRun, InvalidKeysAndFilesHaveMessages) {
  const auto error = [&](const std::string& water, const std::string& sensor = {}) {
    try {
      echoes_in(folder, fan_scene(water, sensor));
    } catch (const std::exception& problem) {
      return std::string(problem.what());
    }
    return std::string();
  };
  EXPECT_THAT(error(still + "volume_scattering_db = 3\n"), HasSubstr("volume_scattering_db"));
  folder.write("a.csv", "depth_m,volume_scattering_db\n5,-60\n");
  EXPECT_THAT(error(still + "volume_scattering_db = -60\nvolume_scattering_file = \"a.csv\"\n"),
              HasSubstr("only one of the two"));
  EXPECT_THAT(error(still + "volume_scattering_file = \"none.csv\"\n"), HasSubstr("none.csv"));
  folder.write("bad.csv", "depth_m,volume_scattering_db\n5,-60\n4,-50\n");
  EXPECT_THAT(error(still + "volume_scattering_file = \"bad.csv\"\n"),
              HasSubstr("bad.csv:3:1: depth_m must increase"));
  folder.write("bad.csv", "depth_m,volume_scattering_db\n5,1\n");
  EXPECT_THAT(error(still + "volume_scattering_file = \"bad.csv\"\n"), HasSubstr("expected -999 to 0"));
  folder.write("bad.csv", "depth_m,volume_scattering_db\n");
  EXPECT_THAT(error(still + "volume_scattering_file = \"bad.csv\"\n"), HasSubstr("no rows"));
  EXPECT_THAT(
      error(still + "volume_scattering_db = -60\nsurface_height_m = 12\n[sea_surface]\nheight_m = 11\n"),
      HasSubstr("depths of layers need one sea surface"));
  const std::string at_apex =
      replaced(fan_scene(still + "volume_scattering_db = -60\n"), "range_min_m = 2", "range_min_m = 0");
  EXPECT_THAT(run_program({"check", folder.write("scene.toml", at_apex).string()}).err,
              HasSubstr("increase 'range_min_m'"));
}

TEST_F(VolumeRun, TiledTerrainHasTheReverberationOfTheWholeTerrain) {
  std::string rows = "ncols 40\nnrows 40\nxllcorner -200\nyllcorner -200\ncellsize 10\n";
  for (int k = 0; k < 1600; ++k) rows += k % 40 == 39 ? "0\n" : "0 ";
  folder.write("bed.asc", rows);
  const auto volume = [&](const std::string& load) {
    const auto scene = [&](const std::string& scattering) {
      return replaced(fan_scene(still + scattering),
                      "kind = \"flat\"\nmaterial = \"sand\"\nwidth_m = 400\nlength_m = 400",
                      "kind = \"raster\"\nmaterial = \"sand\"\nfile = \"bed.asc\"\nload = \"" + load + "\"");
    };
    const Echoes with = echoes_in(folder, scene("volume_scattering_db = -60\n")),
                 without = echoes_in(folder, scene(""));
    std::vector<double> difference(with.energy.size());
    for (std::size_t k = 0; k < difference.size(); ++k) difference[k] = with.energy[k] - without.energy[k];
    return difference;
  };
  const std::vector<double> whole = volume("whole"), tiles = volume("tiles");
  for (std::size_t k = 0; k < whole.size(); ++k)
    EXPECT_NEAR(tiles[k], whole[k], 1e-12 * whole[2 * 60]) << "bin " << k;
  EXPECT_GT(whole[2 * 60], 0);
}

TEST_F(VolumeRun, SonarWithoutSurfaceReceivesTheWater) {
  const std::string scene =
      replaced(fan_scene(still + "volume_scattering_db = -60\n"), "range_max_m = 32", "range_max_m = 8");
  const auto result = run_program({"check", folder.write("scene.toml", scene).string()});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out + result.err, testing::Not(HasSubstr("receives nothing")));
}

TEST_F(VolumeRun, LayersThatEndAboveTheSeabedGiveAWarning) {
  folder.write("layers.csv", "depth_m,volume_scattering_db\n0,-60\n6,-50\n");
  const auto output = [&](const std::string& rows) {
    folder.write("layers.csv", "depth_m,volume_scattering_db\n" + rows);
    const std::string scene =
        fan_scene(still + "volume_scattering_file = \"layers.csv\"\nsurface_height_m = 12\n");
    const auto result = run_program({"check", folder.write("scene.toml", scene).string()});
    return result.out + result.err;
  };
  EXPECT_THAT(output("0,-60\n6,-50\n"),
              HasSubstr("ends at a depth of 6 m, but the scene reaches down to 12 m"));
  EXPECT_THAT(output("0,-60\n6,-50\n12,-999\n"), testing::Not(HasSubstr("ends at a depth")));
}

TEST_F(VolumeRun, PathsViaMirrorsGiveAWarning) {
  const auto warnings = [&](const std::string& more) {
    const std::string scene = fan_scene(still + "volume_scattering_db = -60\n", {}, more);
    return run_program({"check", folder.write("scene.toml", scene).string()}).err;
  };
  const std::string text =
      "contain no volume scattering: sensor 'fan' receives it along the direct path only";
  EXPECT_THAT(warnings("[sea_surface]\nheight_m = 40\n[paths]\norder = 2\n"), HasSubstr(text));
  EXPECT_THAT(warnings({}), testing::Not(HasSubstr(text)));
}

}  // namespace
}  // namespace tubefoot
