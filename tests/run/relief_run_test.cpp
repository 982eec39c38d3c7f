// SPDX-License-Identifier: GPL-3.0-or-later
// Tests relief in whole runs: online and offline refinement, refined meshes from a file, and combinations
// that are rejected.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "run/refined_surface_file.hpp"
#include "scene/scene.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::string_view scene_with_relief = R"(
[[materials]]
name = "sand"
lambert_db = -25
[[materials.relief]]
kind = "ripples"
tile_m = 5.12
resolution_m = 0.04
seed = 7
wavelength_m = 0.4
direction_deg = 20
rms_height_m = 0.02
[[terrain]]
kind = "flat"
width_m = 12
length_m = 12
[trajectory]
kind = "line"
start_m = [0.2, -5, 1.5]
end_m = [0.2, 5, 1.5]
speed_m_s = 1
[[sensors]]
name = "camera"
kind = "didson"
beams = 8
horizontal_deg = 10
vertical_deg = 8
tilt_deg = 35
samples = 100
window_start_m = 2
window_length_m = 2
pings = 3
ping_interval_s = 1
[relief]
cell_m = 0.05
tolerance = 0
)";

std::string offline_scene(std::string_view more = "") {
  return replaced(scene_with_relief, "tolerance = 0", fmt::format("mode = \"offline\"{}", more));
}

struct Result {
  std::vector<double> energy;
  nlohmann::json stats;
  std::string out;
};

Result run_scene(const TestFolder& folder, const std::string& name, std::string_view text,
                 std::vector<std::string> more = {}) {
  const auto file = folder.write(name + ".toml", text);
  std::vector<std::string> arguments{"run", file.string(), "-o", (folder / name).string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Outcome outcome = run_program(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  if (outcome.exit_code != 0) return {};
  std::ifstream stats(folder / name / "stats.json");
  return {read_echoes(folder / name / "echoes.nc", "camera").energy, nlohmann::json::parse(stats),
          outcome.out};
}

TEST(ReliefRun, OnlineEqualsOfflineEqualsTheFile) {
  const TestFolder folder;
  const Result online = run_scene(folder, "online", scene_with_relief),
               offline = run_scene(folder, "offline", offline_scene());
  ASSERT_FALSE(online.energy.empty());
  EXPECT_EQ(online.energy, offline.energy);
  const Outcome refined =
      run_program({"refine", (folder / "offline.toml").string(), "-o", (folder / "bed.ply").string()});
  ASSERT_EQ(refined.exit_code, 0) << refined.err;
  const Result loaded = run_scene(folder, "loaded", offline_scene("\nfile = \"bed.ply\""));
  EXPECT_EQ(loaded.energy, offline.energy);
  EXPECT_EQ(run_scene(folder, "one", scene_with_relief, {"--threads", "1"}).energy, online.energy);
  // The result also differs from flat sand.
  EXPECT_NE(run_scene(folder, "flat", replaced(scene_with_relief, "tolerance = 0", "mode = \"off\"")).energy,
            online.energy);

  const nlohmann::json& told = online.stats.at("relief");
  EXPECT_EQ(told.at("uniform_facets"), offline.stats.at("relief").at("facets_made"));
  EXPECT_EQ(told.at("uniform_facets"), offline.stats.at("facets"));
  EXPECT_EQ(told.at("base_facets"), 2);
  EXPECT_LT(told.at("facets_made").get<double>(), 3 * told.at("uniform_facets").get<double>());
  EXPECT_GT(told.at("change_by_finer_relief").at("largest").get<double>(), 0);
  EXPECT_GE(told.at("change_by_finer_relief").at("largest"), told.at("change_by_finer_relief").at("rms"));
  EXPECT_THAT(online.out, HasSubstr("first-order estimates for the worst ping are not certified"));

  // A refined seabed of another scene, a damaged one, and a missing one.
  const auto refused = [&](std::string_view text) {
    const Outcome outcome = run_program(
        {"run", folder.write("refused.toml", text).string(), "-o", (folder / "refused").string()});
    EXPECT_EQ(outcome.exit_code, 2);
    return outcome.err;
  };
  const std::string with_file = offline_scene("\nfile = \"bed.ply\"");
  EXPECT_THAT(refused(replaced(with_file, "seed = 7", "seed = 8")), HasSubstr("of another scene"));
  EXPECT_THAT(refused(replaced(with_file, "cell_m = 0.05", "cell_m = 0.06")), HasSubstr("of another scene"));
  std::filesystem::resize_file(folder / "bed.ply", std::filesystem::file_size(folder / "bed.ply") - 5);
  EXPECT_THAT(refused(with_file), HasSubstr("shorter or longer"));
  EXPECT_THAT(refused(replaced(with_file, "bed.ply", "no.ply")), HasSubstr("tubefoot refine"));
}

// A refined seabed belongs to another scene if a map of its heights differs, anywhere on two facets.
TEST(ReliefRun, ASeabedIsKnownByItsHeightsAllOverFewFacets) {
  const TestFolder folder;
  constexpr int cells = 60;
  const auto hash = [&](int bump_row, int bump_column) {
    std::string map =
        fmt::format("ncols {}\nnrows {}\nxllcorner -12\nyllcorner -12\ncellsize 0.4\n", cells, cells);
    for (int row = 0; row < cells; ++row)
      for (int column = 0; column < cells; ++column)
        map += row / 10 == bump_row && column / 10 == bump_column ? "0.4 " : "0.1 ";
    folder.write("map.asc", map);
    const Scene loaded = load_scene(
        read_scene_text(flat_terrain(23, 23) +
                            "[[materials]]\nname = \"sand\"\n[[materials.relief]]\nkind = \"map\"\nfile = "
                            "\"map.asc\"\n[relief]\nmode = \"offline\"\ncell_m = 0.3\n[trajectory]\nkind = "
                            "\"fixed\"\n[[sensors]]\nname = \"camera\"\nkind = \"didson\"\n",
                        folder / "scene.toml"));
    return seabed_hash(loaded, 0.3);
  };
  std::set<std::string> hashes{hash(-1, -1)};
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column)
      EXPECT_TRUE(hashes.insert(hash(row, column)).second) << row << " " << column;
}

// Relief is refined in the view of refracted rays, with the receiver at the transmitter and separate.
TEST(ReliefRun, RefractingWaterSeesTheTransmissionsSurface) {
  const TestFolder folder;
  const std::string water =
      "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1600\ngradient_per_s = -10\nprofile_bottom_m = "
      "12\nsurface_height_m = 8\nabsorption_db_per_km = 100\n";
  for (const std::string apart : {"", "\nreceiver_arm_m = [0, -0.4, 0.2]"}) {
    SCOPED_TRACE(apart);
    const auto with = [&](const std::string& text) {
      return water + replaced(text, "pings = 3\nping_interval_s = 1", "pings = 1" + apart);
    };
    const Result online = run_scene(folder, "online", with(std::string(scene_with_relief))),
                 offline = run_scene(folder, "offline", with(offline_scene()));
    ASSERT_FALSE(online.energy.empty());
    EXPECT_EQ(online.energy, offline.energy);
    EXPECT_GT(online.stats.at("relief").at("facets_made").get<double>(), 500);
    EXPECT_EQ(online.stats.at("refraction").at("facets_in_shadow"), 0);
    EXPECT_NE(run_scene(folder, "even",
                        replaced(scene_with_relief, "pings = 3\nping_interval_s = 1", "pings = 1" + apart))
                  .energy,
              online.energy);
  }
}

// Parts above the water are neither visible nor reflected, for both modes of refinement.
TEST(ReliefRun, RefractingWaterEndsReliefAtTheSurface) {
  const TestFolder folder;
  const auto with = [](const std::string& text) {
    return "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1600\ngradient_per_s = -10\n"
           "profile_bottom_m = 12\nsurface_height_m = 2\n[sea_surface]\nheight_m = 2\n"
           "[[objects]]\nname = \"post\"\nshape = \"box\"\nsize_m = [2, 0.2, 4]\nposition_m = [0.2, -2.3, "
           "1]\nmaterial = \"sand\"\n" +
           replaced(replaced(text, "pings = 3\nping_interval_s = 1", "pings = 1"), "tilt_deg = 35",
                    "tilt_deg = -12");
  };
  const Result online = run_scene(folder, "online", with(std::string(scene_with_relief))),
               offline = run_scene(folder, "offline", with(offline_scene()));
  ASSERT_FALSE(online.energy.empty());
  EXPECT_EQ(online.energy, offline.energy);
  EXPECT_GT(std::accumulate(online.energy.begin(), online.energy.end(), 0.0), 0);
}

TEST(ReliefRun, AuditAndFootprintsSeeTheTransmissionsSurface) {
  const TestFolder folder;
  const auto file =
      folder.write("scene.toml", replaced(scene_with_relief, "tolerance = 0", "tolerance = 0.05"));
  const Outcome audit = run_program({"audit", file.string(), "--quiet"});
  EXPECT_EQ(audit.exit_code, 0) << audit.out;
  EXPECT_THAT(audit.out, HasSubstr("failures       0"));
  const Outcome footprints = run_program(
      {"footprints", file.string(), "--sensor", "camera", "-o", (folder / "footprints.csv").string()});
  ASSERT_EQ(footprints.exit_code, 0) << footprints.err;
  EXPECT_THAT(bytes_of(folder / "footprints.csv"), HasSubstr("base_facet"));
  const Outcome check = run_program({"check", file.string(), "--quiet"});
  EXPECT_EQ(check.exit_code, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("relief         online"));
}

TEST(ReliefRun, OtherEnginesAndTheReferenceSeeItToo) {
  const TestFolder folder;
  const std::string few = replaced(scene_with_relief, "pings = 3", "pings = 1");
  const Result tubes = run_scene(folder, "tubes", few);
  const Result rays = run_scene(folder, "rays", few, {"--engine", "ray", "--rays", "400000"});
  double sum = 0, apart = 0;
  ASSERT_EQ(tubes.energy.size(), rays.energy.size());
  for (std::size_t k = 0; k < tubes.energy.size(); ++k) {
    sum += tubes.energy[k];
    apart += std::abs(tubes.energy[k] - rays.energy[k]);
  }
  EXPECT_LT(apart, 0.02 * sum);
  const Result certified = run_scene(folder, "certified", few, {"--reference", "--tolerance", "1e-6"});
  for (std::size_t k = 0; k < certified.energy.size(); ++k)
    EXPECT_NEAR(certified.energy[k], tubes.energy[k], 1e-6 * tubes.energy[k]);
}

TEST(ReliefRun, TheRunsToleranceIsTheReliefsUnlessTheSceneSaysOne) {
  const TestFolder folder;
  const std::string silent =
                        replaced(replaced(scene_with_relief, "tolerance = 0", ""), "pings = 3", "pings = 2"),
                    spoken = replaced(silent, "cell_m = 0.05", "cell_m = 0.05\ntolerance = 0.2");
  const auto taken = [&](const std::string& name, std::string_view text, std::vector<std::string> more) {
    return run_scene(folder, name, text, std::move(more)).stats.at("relief").at("tolerance").get<double>();
  };
  EXPECT_EQ(taken("default", silent, {}), 0.01);
  EXPECT_NEAR(taken("db", silent, {"--tolerance", "3dB"}), 1 - std::pow(10, -0.3), 1e-12);
  EXPECT_EQ(taken("relative", silent, {"--tolerance", "10%"}), 0.1);
  EXPECT_EQ(taken("spoken", spoken, {"--tolerance", "10%"}), 0.2);
  // In a reference the tolerance is the bound of the bins, and does not apply to the relief.
  EXPECT_EQ(taken("reference", silent, {"--reference", "--tolerance", "0.1"}), 0.01);
}

constexpr std::string_view apart = R"(
lever_arm_m = [-0.03, 0, 0]
receiver_arm_m = [0.03, 0, 0])";

TEST(ReliefRun, ASeparateReceiverAndSensorsThatShareTransmissionsSeeTheTransmissionsSurface) {
  const TestFolder folder;
  const std::string head(scene_with_relief.substr(0, scene_with_relief.find("[relief]"))),
      tail(scene_with_relief.substr(scene_with_relief.find("[relief]")));
  const std::string camera = head.substr(head.find("[[sensors]]"));
  // The second sensor has a longer range: the surface must extend to the longest range.
  const std::string two =
      head +
      replaced(replaced(camera, "\"camera\"", "\"far\""), "window_length_m = 2", "window_length_m = 3") +
      tail;
  const std::string receiver =
      replaced(scene_with_relief, "tilt_deg = 35", "tilt_deg = 35" + std::string(apart));
  for (const auto& [name, text] : {std::pair<std::string, std::string>{"two", two}, {"apart", receiver}}) {
    const Result online = run_scene(folder, name + "-online", text),
                 offline = run_scene(folder, name + "-offline",
                                     replaced(text, "tolerance = 0", "mode = \"offline\""));
    ASSERT_FALSE(online.energy.empty());
    double sum = 0, differ = 0;
    for (std::size_t k = 0; k < online.energy.size(); ++k) {
      sum += offline.energy[k];
      differ += std::abs(online.energy[k] - offline.energy[k]);
    }
    EXPECT_GT(sum, 0);
    EXPECT_LE(differ, 1e-12 * sum) << name;
    const nlohmann::json &change = online.stats.at("relief").at("change_by_finer_relief"),
                         &same = offline.stats.at("relief").at("change_by_finer_relief");
    EXPECT_GT(change.at("largest").get<double>(), 0) << name;
    EXPECT_NEAR(change.at("rms").get<double>(), same.at("rms").get<double>(),
                1e-9 * same.at("rms").get<double>())
        << name;
  }
}

TEST(ReliefRun, TransmissionsThatSeeNoReliefAreThoseOfFlatSurface) {
  const TestFolder folder;
  // Relief on an object only, next to the track; and a track that looks past everything.
  const std::string object = replaced(scene_with_relief, "[[terrain]]",
                                      R"([[materials]]
name = "mud"
lambert_db = -30
[[objects]]
name = "stone"
shape = "sphere"
radius_m = 0.5
chord_error_m = 0.01
material = "sand"
position_m = [4, 4, 0]
[[terrain]]
material = "mud")");
  const Result with = run_scene(folder, "object", object),
               flat = run_scene(folder, "flat", replaced(object, "tolerance = 0", "mode = \"off\""));
  ASSERT_FALSE(with.energy.empty());
  EXPECT_EQ(with.energy, flat.energy);
  const Result over = run_scene(folder, "over",
                                replaced(replaced(scene_with_relief, "[0.2, -5, 1.5]", "[0.2, -5, 50]"),
                                         "[0.2, 5, 1.5]", "[0.2, 5, 50]"));
  ASSERT_FALSE(over.energy.empty());
  for (const double energy : over.energy) EXPECT_EQ(energy, 0);
  EXPECT_EQ(over.stats.at("relief").at("facets_made"), 0);
}

TEST(ReliefRun, RefusesWhatCannotBe) {
  const TestFolder folder;
  const auto refused = [&](std::string_view text, const std::string& command = "check") {
    const auto file = folder.write("scene.toml", text);
    const Outcome outcome = command == "check"
                                ? run_program({"check", file.string()})
                                : run_program({command, file.string(), "-o", (folder / "x").string()});
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    return outcome.err;
  };
  // The sensor is 1 mm above the flat seabed, but under a crest of the relief somewhere.
  EXPECT_THAT(refused(replaced(replaced(scene_with_relief, "[0.2, -5, 1.5]", "[0.2, -5, 0.001]"),
                               "[0.2, 5, 1.5]", "[0.2, 5, 0.001]")),
              HasSubstr("below the seabed"));
  EXPECT_THAT(refused(replaced(scene_with_relief, "cell_m = 0.05", "cell_m = 1e-6")),
              HasSubstr("too small for the grid"));
  const std::string vast =
      replaced(replaced(offline_scene(), "cell_m = 0.05", "cell_m = 0.001"), "width_m = 12", "width_m = 64");
  EXPECT_THAT(refused(vast), HasSubstr("facets, more than 100000000"));
  EXPECT_THAT(refused(replaced(scene_with_relief, "tolerance = 0", "mode = \"off\""), "refine"),
              HasSubstr("nothing to refine"));
  // A level mirror with relief is not level.
  EXPECT_THAT(
      refused("[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = "
              "1\nprofile_bottom_m = 12\nsurface_height_m = 8\n" +
              replaced(scene_with_relief, "lambert_db = -25", "lambert_db = -25\nspecular_loss_db = 10")),
      AllOf(HasSubstr("is a mirror on facets that are not horizontal"), HasSubstr("scene.toml:")));
}

}  // namespace
}  // namespace tubefoot
