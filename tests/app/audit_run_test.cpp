// SPDX-License-Identifier: GPL-3.0-or-later
// Tests `tubefoot audit`. The closure law holds in each tube. The visible polygons do not depend on
// arithmetic, threads, or the order of facets and vertices in a file.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "fixtures/program.hpp"
#include "fixtures/test_mesh.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Returns the lines of an audit by their first words.
std::map<std::string, std::string> audited(const fs::path& scene, std::vector<std::string> arguments = {}) {
  arguments.insert(arguments.begin(), {"audit", scene.string(), "--quiet"});
  const Outcome outcome = run_program(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err << outcome.out;
  std::map<std::string, std::string> lines;
  std::istringstream stream(outcome.out);
  for (std::string line; std::getline(stream, line);) {
    const std::size_t gap = line.find("  ");
    if (gap == std::string::npos) continue;
    lines[line.substr(0, gap)] = line.substr(line.find_first_not_of(' ', gap));
  }
  EXPECT_EQ(lines["failures"], "0");
  EXPECT_EQ(lines["topology hash"].size(), 32u);
  return lines;
}

constexpr std::string_view looks = R"(
[[trajectories]]
name = "above"
kind = "fixed"
position_m = [0.3, -4, 3]
[[trajectories]]
name = "past"
kind = "line"
start_m = [-5, -1, 2.5]
end_m = [-5, 1, 2.5]
[[sensors]]
name = "camera"
kind = "didson"
trajectory = "above"
tilt_deg = 30
beams = 16
[[sensors]]
name = "sidescan"
kind = "sidescan"
trajectory = "past"
pings = 2
ping_interval_s = 0.5
range_max_m = 20
)";

/// Bodies that intersect each other and the seabed. No edge of one lies on an edge of another.
constexpr std::string_view interpenetrating = R"(
[[materials]]
name = "sand"
[[terrain]]
kind = "fractal"
width_m = 16
length_m = 16
cell_m = 0.4
rms_height_m = 0.1
[[objects]]
name = "ball"
shape = "sphere"
radius_m = 0.7
chord_error_m = 0.01
position_m = [0, 1, 0.3]
[[objects]]
name = "box"
shape = "box"
position_m = [0.6, 1.2, 0.1]
heading_deg = 31
pitch_deg = 12
[[objects]]
name = "pipe"
shape = "cylinder"
radius_m = 0.2
height_m = 3
position_m = [0.1, 1.1, 0.4]
pitch_deg = 80
heading_deg = 77
[[objects]]
name = "cone"
shape = "cone"
radius_m = 0.6
height_m = 1.4
position_m = [-0.7, 0.7, 0.2]
)";

TEST(Audit, InterpenetratingBodiesCloseAndHashAlikeInEveryExactArithmetic) {
  const TestFolder folder;
  const auto scene = folder.write("scene.toml", std::string(interpenetrating) + std::string(looks));
  auto fixed = audited(scene, {"--arithmetic", "fixed"});
  EXPECT_EQ(fixed["arithmetic"], "fixed");
  EXPECT_EQ(fixed["transmissions"], "3");
  EXPECT_GT(std::stoi(fixed["footprints"]), 500);
  EXPECT_GE(std::stoi(fixed["pieces"]), std::stoi(fixed["footprints"]));
  for (const char* arithmetic : {"filtered", "rational"}) {
    auto other = audited(scene, {"--arithmetic", arithmetic});
    EXPECT_EQ(other["arithmetic"], arithmetic);
    EXPECT_EQ(other["topology hash"], fixed["topology hash"]) << arithmetic;
    EXPECT_EQ(other["footprints"], fixed["footprints"]) << arithmetic;
  }
  for (const char* threads : {"1", "2", "5"})
    EXPECT_EQ(audited(scene, {"--threads", threads})["topology hash"], fixed["topology hash"]) << threads;
}

double bumps(double east, double north) {
  return 0.4 * std::sin(0.9 * east + 0.2) * std::cos(0.7 * north) + 0.2 * std::sin(3 * east - 2 * north);
}

std::string mesh_scene() {
  return "[[materials]]\nname = \"sand\"\n[[objects]]\nname = \"bed\"\nshape = \"mesh\"\nfile = "
         "\"bed.obj\"\n" +
         std::string(looks);
}

TEST(Audit, OrderOfFacetsAndVerticesDoesNotChangeTheHash) {
  const TestFolder folder;
  const auto scene = folder.write("scene.toml", mesh_scene());
  const TestMesh mesh = relief(24, 24, bumps);
  folder.write("bed.obj", obj_text(mesh));
  auto first = audited(scene);
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    SCOPED_TRACE(seed);
    folder.write("bed.obj", obj_text(shuffled(mesh, seed)));
    auto other = audited(scene);
    EXPECT_EQ(other["topology hash"], first["topology hash"]);
    EXPECT_EQ(other["footprints"], first["footprints"]);
  }
}

// A constant hash proves nothing: the smallest move of a visible vertex must change it.
TEST(Audit, HashFollowsWhatIsVisible) {
  const TestFolder folder;
  const auto scene = folder.write("scene.toml", mesh_scene());
  const TestMesh mesh = relief(24, 24, bumps);
  folder.write("bed.obj", obj_text(mesh));
  std::set<std::string> hashes{audited(scene)["topology hash"]};
  for (const auto& [east, north] : {std::pair{-1, 1}, {0, 1}, {1, 1}, {2, 1}, {0, 0}, {1, 2}}) {
    SCOPED_TRACE(fmt::format("{} {}", east, north));
    TestMesh moved = mesh;
    const auto in_view = std::find_if(
        moved.vertices.begin(), moved.vertices.end(),
        [east = east, north = north](const auto& vertex) { return vertex[0] == east && vertex[1] == north; });
    ASSERT_NE(in_view, moved.vertices.end());
    (*in_view)[2] += 1.0 / 65536;
    folder.write("bed.obj", obj_text(moved));
    EXPECT_TRUE(hashes.insert(audited(scene)["topology hash"]).second);
  }
}

TEST(Audit, SensorAndPingsChooseWhatIsAudited) {
  const TestFolder folder;
  const auto scene = folder.write("scene.toml", std::string(interpenetrating) + std::string(looks));
  EXPECT_EQ(audited(scene, {"--sensor", "sidescan"})["transmissions"], "2");
  EXPECT_EQ(audited(scene, {"--sensor", "sidescan", "--pings", "1"})["transmissions"], "1");
  EXPECT_EQ(audited(scene, {"--sensor", "camera", "--pings", "0:"})["transmissions"], "1");
}

// The audit of a separate receiver covers the tubes of both ends and their common parts. An earlier version
// audited only the tubes of the transmitter, and reported full proof.
TEST(AuditOfASeparateReceiver, ClosesForBothEndsAndHashesAlikeInEveryExactArithmetic) {
  const TestFolder folder;
  const auto scene_with = [&](const std::string& first, const std::string& more) {
    std::string text(looks);
    const std::string camera = "tilt_deg = 30\nbeams = 16\n";
    text.replace(text.find(camera), camera.size(), "tilt_deg = 30\nbeams = 4\nhorizontal_deg = 16\n" + more);
    return folder.write("scene.toml", first + std::string(interpenetrating) + text);
  };
  const std::vector<std::string> of_camera{"--sensor", "camera"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), of_camera.begin(), of_camera.end());
    return more;
  };
  const std::string refracted =
      "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = 0.5\nprofile_bottom_m = 30\n"
      "surface_height_m = 10\n";
  auto alone = audited(scene_with("", ""), of_camera);
  EXPECT_EQ(alone.count("shared pieces"), 0u);
  for (const std::string& water : {std::string(), refracted}) {
    SCOPED_TRACE(water);
    const auto scene = scene_with(water, "receiver_arm_m = [0.3, 0.1, 0.1]\n");
    auto fixed = audited(scene, with({"--arithmetic", "fixed"}));
    EXPECT_EQ(std::stoi(fixed["tubes"]), 2 * std::stoi(alone["tubes"]));
    EXPECT_GT(std::stoi(fixed["shared facets"]), 30);
    EXPECT_GE(std::stoi(fixed["shared pieces"]), std::stoi(fixed["shared facets"]));
    for (const char* arithmetic : {"filtered", "rational"}) {
      if (!water.empty() && arithmetic == std::string("rational")) continue;  // it takes too long
      auto other = audited(scene, with({"--arithmetic", arithmetic}));
      EXPECT_EQ(other["topology hash"], fixed["topology hash"]) << arithmetic;
      EXPECT_EQ(other["shared facets"], fixed["shared facets"]) << arithmetic;
    }
    EXPECT_EQ(audited(scene, with({"--threads", "1"}))["topology hash"], fixed["topology hash"]);
    // The hash depends on the position of the receiver.
    EXPECT_NE(audited(scene_with(water, "receiver_arm_m = [0.3, 0.1, 0.11]\n"), of_camera)["topology hash"],
              fixed["topology hash"]);
  }
}

// Paths over mirrors: each view of each image, and the common parts of pairs of images.
TEST(AuditOverMirrors, ProvesEveryPathAndHashesAlikeInEveryExactArithmetic) {
  const TestFolder folder;
  const auto scene_with = [&](std::string_view water, std::string_view wall, std::string_view sonar,
                              int order) {
    return folder.write(
        "scene.toml",
        fmt::format(
            "{}[sea_surface]\nloss_db = 1\n[paths]\norder = {}\n[[materials]]\nname = \"sand\"\n"
            "[[materials]]\nname = \"steel\"\n{}[[terrain]]\nkind = \"fractal\"\n"
            "width_m = 12\nlength_m = 12\ncell_m = 1.5\nrms_height_m = 0.1\ncentre_m = [0, 0, -5]\n"
            "material = \"sand\"\n[[objects]]\nname = \"lid\"\nshape = \"box\"\nmaterial = \"steel\"\n"
            "size_m = [1.5, 3, 0.4]\nposition_m = [2.5, 0, -3.5]\n{}[trajectory]\nkind = \"fixed\"\n"
            "position_m = [0.2, 0.1, -2]\n[[sensors]]\nname = \"sonar\"\nkind = \"sidescan\"\n"
            "along_track_deg = 40\nrange_max_m = 9\ndepression_min_deg = -60\n"
            "depression_max_deg = 60\n{}",
            water, order, wall.empty() ? "" : "specular_loss_db = 3\n", wall, sonar));
  };
  constexpr std::string_view leaning = "pitch_deg = 20\n", apart = "receiver_arm_m = [0.3, 0.1, 0.1]\n",
                             refracted =
                                 "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = "
                                 "0.5\nprofile_bottom_m = 30\n";
  struct {
    std::string_view water, wall, sonar;
  } const cases[] = {{"", leaning, ""}, {"", leaning, apart}, {refracted, "", ""}, {refracted, "", apart}};
  for (const auto& [water, wall, sonar] : cases) {
    SCOPED_TRACE(fmt::format("{}{}{}", water, wall, sonar));
    auto once = audited(scene_with(water, wall, sonar, 1));
    EXPECT_EQ(once.count("images"), 0u);
    const auto scene = scene_with(water, wall, sonar, 3);
    auto fixed = audited(scene);
    EXPECT_GE(std::stoi(fixed["images"]), 2);
    EXPECT_GE(std::stoi(fixed["image pairs"]), 2);
    EXPECT_GT(std::stoi(fixed["tubes"]), std::stoi(once["tubes"]));
    EXPECT_GT(std::stoi(fixed["shared facets"]), 10);
    EXPECT_NE(fixed["topology hash"], once["topology hash"]);
    EXPECT_EQ(audited(scene, {"--threads", "1"})["topology hash"], fixed["topology hash"]);
    for (const char* arithmetic : {"filtered", "rational"}) {
      if (arithmetic == std::string("rational") && !(water.empty() && sonar.empty())) continue;
      EXPECT_EQ(audited(scene, {"--arithmetic", arithmetic})["topology hash"], fixed["topology hash"])
          << arithmetic;
    }
  }
}

TEST(AuditOverMirrors, ShallowWater) {
  const fs::path scene = fs::path(TUBEFOOT_SOURCE_DIR) / "scenes/paths/shallow-water.toml";
  auto found = audited(scene, {"--pings", "120"});
  EXPECT_GE(std::stoi(found["images"]), 4);
  EXPECT_GT(std::stoi(found["shared facets"]), 20);
}

// Rounding must be visible somewhere, or the law proves nothing. Doubles without tolerance may break the
// law, and must then report this and fail. They may also succeed.
TEST(Audit, ExitCodeFollowsTheFailures) {
  const TestFolder folder;
  const auto scene = folder.write("scene.toml", std::string(interpenetrating) + std::string(looks));
  const Outcome outcome = run_program({"audit", scene.string(), "--arithmetic", "double", "--quiet"});
  const bool closed = outcome.out.find("failures       0\n") != std::string::npos;
  EXPECT_EQ(outcome.exit_code, closed ? 0 : 1) << outcome.out;
  EXPECT_EQ(outcome.err.find("off by") == std::string::npos, closed);
}

TEST(AuditOfRealData, PanelOnASurveyedSeabed) {
  const fs::path scene = TUBEFOOT_SOURCE_DIR "/scenes/real-grid/scene.toml";
  auto camera = audited(scene, {"--sensor", "camera"});
  EXPECT_GT(std::stoi(camera["footprints"]), 1000);
  EXPECT_EQ(audited(scene, {"--sensor", "camera", "--arithmetic", "filtered"})["topology hash"],
            camera["topology hash"]);
  const std::vector<std::string> beside_panel{"--sensor", "sidescan", "--pings", "160"};
  auto rational = beside_panel;
  rational.insert(rational.end(), {"--arithmetic", "rational"});
  EXPECT_EQ(audited(scene, beside_panel)["topology hash"], audited(scene, rational)["topology hash"]);
}

TEST(AuditOfRealData, LakeSeabed) {
  const fs::path scene = TUBEFOOT_SOURCE_DIR "/scenes/lake/scene.toml";
  for (const char* pings : {"0:2", "150"}) {
    SCOPED_TRACE(pings);
    auto fixed = audited(scene, {"--pings", pings});
    for (const char* arithmetic : {"filtered", "rational"})
      EXPECT_EQ(audited(scene, {"--pings", pings, "--arithmetic", arithmetic})["topology hash"],
                fixed["topology hash"])
          << arithmetic;
  }
}

TEST(AuditOfShippedScenes, WellHead) {
  const fs::path scene = fs::path(TUBEFOOT_SOURCE_DIR) / "scenes/wellhead/scene.toml";
  const std::vector<std::string> look{"--sensor", "sidescan", "--pings", "180"};
  auto filtered = look;
  filtered.insert(filtered.end(), {"--arithmetic", "filtered"});
  EXPECT_EQ(audited(scene, look)["topology hash"], audited(scene, filtered)["topology hash"]);
}

}  // namespace
}  // namespace tubefoot
