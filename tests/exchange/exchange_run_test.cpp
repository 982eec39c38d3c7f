// SPDX-License-Identifier: GPL-3.0-or-later
// Tests export and import: the same triangles at their positions, the same sonar and the same energies. The
// sonar comes from the native elements of the other engine as well as from tubefoot's own elements.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <pugixml.hpp>

#include "exchange/exchanged_scene.hpp"
#include "exchange/frames.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/program.hpp"
#include "fixtures/test_folder.hpp"
#include "run/survey.hpp"
#include "scene/meshes/mesh_file.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

constexpr std::string_view seabed = R"(title = "Box, wall & ball"
[water]
sound_speed_m_s = 1500
absorption_db_per_km = 120
[[materials]]
name = "sand <fine>"
lambert_db = -25
[[materials]]
name = "rock"
lambert_db = -9
[[terrain]]
kind = "flat"
material = "sand <fine>"
width_m = 30
length_m = 40
slope_deg = 3
[[objects]]
name = "a box"
shape = "box"
material = "rock"
size_m = [1, 2, 1.5]
position_m = [2, 7.3, 0.4]
heading_deg = 33
[[objects]]
name = "ball"
shape = "sphere"
material = "rock"
radius_m = 0.6
position_m = [-1.3, 6, 0.9]
chord_error_m = 0.02
)";

const std::map<std::string, std::string> sonars{{"imaging", R"(kind = "imaging"
beams = 12
horizontal_deg = 60
vertical_deg = 20
samples = 100
range_min_m = 1
range_max_m = 15
tilt_deg = 20
)"},
                                                {"sidescan", R"(kind = "sidescan"
along_track_deg = 2
depression_min_deg = 10
depression_max_deg = 80
samples = 100
range_min_m = 1
range_max_m = 15
)"},
                                                {"multibeam", R"(kind = "multibeam"
beams = 9
swath_deg = 80
beam_across_deg = 4
along_track_deg = 3
samples = 100
range_min_m = 1
range_max_m = 15
)"},
                                                {"scanning", R"(kind = "scanning"
scan_deg = 90
step_deg = 10
beam_horizontal_deg = 4
beam_vertical_deg = 30
samples = 100
range_min_m = 1
range_max_m = 15
tilt_deg = 15
step_interval_s = 0.1
)"}};

std::string scene_with(const std::string& kind) {
  return std::string(seabed) +
         "[trajectory]\nkind = \"fixed\"\nposition_m = [0.5, -1.25, 4]\nheading_deg = 12\n" +
         "pitch_deg = -3\nroll_deg = 4\n[[sensors]]\nname = \"sonar\"\nlever_arm_m = [0.2, 0.5, "
         "-0.1]\nyaw_deg = 5\n" +
         sonars.at(kind);
}

/// Runs the command, and fails the test if the command fails.
std::string done(const std::vector<std::string>& words) {
  const Outcome outcome = run_program(words);
  EXPECT_EQ(outcome.exit_code, 0) << words.front() << ": " << outcome.err;
  return outcome.err + outcome.out;
}

struct Exchange : testing::Test {
  TestFolder folder;
  std::string name(const std::string& of) const { return (folder / of).string(); }
  static std::string file_of(const std::string& format) {
    return format == "sdf" ? "scene.sdf" : "scene.scn";
  }

  ExchangedScene load(const fs::path& file) const {
    const auto survey = open_survey(read_scene_file(file));
    return exchanged_scene(*survey, {}, 0);
  }
  std::vector<double> energies(const std::string& scene, const std::string& result) {
    done({"run", scene, "--quiet", "--pictures", "none", "-o", name(result)});
    return NetcdfReader(folder / (result + "/echoes.nc")).values("/", "energy");
  }
};

TEST_F(Exchange, BringsBackTrianglesSonarAndEnergies) {
  for (const auto& [kind, keys] : sonars) {
    folder.write(kind + ".toml", scene_with(kind));
    const ExchangedScene own = load(folder / (kind + ".toml"));
    const std::vector<double> truth = energies(name(kind + ".toml"), kind + "-run");
    const double largest = *std::ranges::max_element(truth);
    ASSERT_GT(largest, 0) << kind;
    for (const std::string format : {"sdf", "stonefish"}) {
      const std::string out = kind + "-" + format;
      SCOPED_TRACE(out);
      done({"export", name(kind + ".toml"), "--to", format, "--quiet", "-o", name(out)});
      done({"import-scene", name(out + "/" + file_of(format)), "--quiet", "-o", name(out + "-in")});
      const ExchangedScene again = load(folder / (out + "-in/scene.toml"));
      ASSERT_EQ(again.pieces.size(), own.pieces.size());
      double farthest = 0;
      for (std::size_t k = 0; k < own.pieces.size(); ++k) {
        ASSERT_EQ(again.pieces[k].triangles, own.pieces[k].triangles);
        for (std::size_t p = 0; p < own.pieces[k].points_m.size(); ++p)
          farthest = std::max(farthest, glm::length(again.pieces[k].points_m[p] - own.pieces[k].points_m[p]));
        EXPECT_EQ(again.materials[again.pieces[k].material].name, own.materials[own.pieces[k].material].name);
        EXPECT_EQ(again.materials[again.pieces[k].material].lambert_db,
                  own.materials[own.pieces[k].material].lambert_db);
      }
      EXPECT_LT(farthest, 1e-9);
      ASSERT_EQ(again.sonars.size(), 1);
      EXPECT_EQ(again.sonars[0].keys, own.sonars[0].keys);
      EXPECT_EQ(again.sonars[0].azimuth_deg, own.sonars[0].azimuth_deg);
      EXPECT_LT(glm::length(again.sonars[0].own.position_m - own.sonars[0].own.position_m), 1e-12);
      for (int c = 0; c < 3; ++c)
        EXPECT_LT(glm::length(again.sonars[0].own.turn[c] - own.sonars[0].own.turn[c]), 1e-12);
      const std::vector<double> same = energies(name(out + "-in/scene.toml"), out + "-run");
      ASSERT_EQ(same.size(), truth.size());
      double off = 0, all = 0;
      for (std::size_t k = 0; k < truth.size(); ++k) off += std::abs(same[k] - truth[k]), all += truth[k];
      EXPECT_LT(off, 1e-9 * all);
    }
  }
}

/// Removes the element of tubefoot's own sonar, so that only the elements for other engines remain.
void without_own_sonar(const fs::path& file) {
  pugi::xml_document document;
  ASSERT_TRUE(document.load_file(file.c_str()));
  const auto found = document.select_nodes("//*[name()='tubefoot:sonar']");
  ASSERT_EQ(found.size(), 1);
  for (const pugi::xpath_node& node : found) node.parent().remove_child(node.node());
  ASSERT_TRUE(document.save_file(file.c_str()));
}

/// The native elements of another engine mean the same sonar: a sonar with exact elements there returns
/// with the same energies. (Not exact: a fan of Stonefish, whose beams are equidistant.)
TEST_F(Exchange, MeansTheSameInTheEnginesOwnWords) {
  struct Case {
    const char *kind, *format;
    std::size_t samples, first_beam;  ///< range bins of each beam there, and its number of the first beam
  };
  // The exported sonars have 7 additional range bins of 0.14 m in front of the first one at 1 m. Stonefish
  // needs an even number of bins in a scan, and DAVE an odd number of beams.
  for (const Case& c : {Case{"sidescan", "stonefish", 107, 0}, Case{"scanning", "stonefish", 108, 0},
                        Case{"imaging", "sdf", 107, 1}}) {
    const std::string scene = std::string(c.kind) + ".toml", out = std::string(c.kind) + "-out";
    SCOPED_TRACE(out);
    folder.write(scene, scene_with(c.kind));
    done({"export", name(scene), "--to", c.format, "--quiet", "-o", name(out)});
    without_own_sonar(folder / (out + "/" + file_of(c.format)));
    const std::string told =
        done({"import-scene", name(out + "/" + file_of(c.format)), "-o", name(out + "-in")});
    if (c.format == std::string("stonefish")) {
      EXPECT_THAT(told, HasSubstr("frequency"));
    }
    const std::vector<double> truth = energies(name(scene), out + "-own"),
                              same = energies(name(out + "-in/scene.toml"), out + "-run");
    constexpr std::size_t samples = 100, nearer = 7;
    const std::size_t rows = truth.size() / samples;
    ASSERT_EQ(same.size(), (rows + c.first_beam) * c.samples);
    double off = 0, all = 0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      off += std::abs(same[(k / samples + c.first_beam) * c.samples + nearer + k % samples] - truth[k]);
      all += truth[k];
    }
    EXPECT_LT(off, 1e-9 * all);
  }
}

TEST_F(Exchange, WritesObjBitForBitAndGltfToAFloat) {
  folder.write("scene.toml", scene_with("imaging"));
  const ExchangedScene own = load(folder / "scene.toml");
  for (const std::string format : {"obj", "gltf"}) {
    done({"export", name("scene.toml"), "--to", format, "--quiet", "-o", name(format)});
    const NamedMesh mesh = read_mesh_file(folder / (format + "/scene." + format));
    std::size_t triangle = 0;
    double farthest = 0;
    for (const ExchangedPiece& piece : own.pieces)
      for (const auto& corners : piece.triangles) {
        ASSERT_LT(triangle, mesh.triangles.size());
        for (std::size_t k = 0; k < 3; ++k)
          farthest = std::max(
              farthest, glm::length(mesh.points_m[mesh.triangles[triangle][k]] - piece.points_m[corners[k]]));
        ++triangle;
      }
    EXPECT_EQ(triangle, mesh.triangles.size());
    if (format == "obj")
      EXPECT_EQ(farthest, 0);
    else
      EXPECT_LT(farthest, std::sqrt(3.0) * float_rounding_m(32) + 1e-12);
  }
  std::ifstream file(folder / "gltf/scene.gltf");
  const nlohmann::json gltf = nlohmann::json::parse(file);
  EXPECT_EQ(gltf["asset"]["version"], "2.0");
  EXPECT_EQ(gltf["nodes"].back()["name"], "sonar");
  EXPECT_NEAR(gltf["cameras"][0]["perspective"]["yfov"], 20 * std::numbers::pi / 180, 1e-12);
  EXPECT_EQ(gltf["buffers"][0]["byteLength"], fs::file_size(folder / "gltf/scene.bin"));
}

TEST_F(Exchange, WritesWhatTheEnginesAskFor) {
  folder.write("scene.toml", scene_with("sidescan"));
  done({"export", name("scene.toml"), "--to", "stonefish", "--quiet", "-o", name("scn")});
  pugi::xml_document scn;
  ASSERT_TRUE(scn.load_file((folder / "scn/scene.scn").c_str()));
  const pugi::xml_node scenario = scn.child("scenario"), sss = scenario.child("sensor");
  for (const char* needed : {"environment", "materials", "looks", "static"})
    EXPECT_TRUE(scenario.child(needed)) << needed;
  EXPECT_STREQ(sss.attribute("type").value(), "sss");
  EXPECT_EQ(sss.child("specs").attribute("bins").as_int(), 214);
  EXPECT_EQ(sss.child("specs").attribute("vertical_beam_width").as_double(), 70);
  EXPECT_EQ(sss.child("specs").attribute("vertical_tilt").as_double(), 45);
  EXPECT_EQ(scenario.child("materials").select_nodes("material").size(), 2);
  EXPECT_EQ(scenario.child("materials").select_nodes("friction_table/friction").size(), 3);

  done({"export", name("scene.toml"), "--to", "sdf", "--quiet", "-o", name("sdf")});
  pugi::xml_document sdf;
  ASSERT_TRUE(sdf.load_file((folder / "sdf/scene.sdf").c_str()));
  EXPECT_EQ(sdf.select_nodes("/sdf/world/model").size(), 4);
  EXPECT_EQ(sdf.select_nodes("//visual/geometry/mesh/uri").size(), 3);
  EXPECT_EQ(sdf.select_nodes("//sensor").size(), 2);
  EXPECT_THAT(bytes_of(folder / "sdf/README.txt"), HasSubstr("beam 0 looks to port"));

  done({"export", name("scene.toml"), "--to", "holoocean", "--quiet", "-o", name("holo")});
  std::ifstream file(folder / "holo/scenario.json");
  const nlohmann::json holo = nlohmann::json::parse(file);
  const nlohmann::json& sensor = holo["agents"][0]["sensors"][0];
  EXPECT_EQ(sensor["sensor_type"], "SidescanSonar");
  EXPECT_EQ(sensor["configuration"]["RangeBins"], 200);
  EXPECT_EQ(sensor["configuration"]["Azimuth"], 160);
  EXPECT_EQ(holo["agents"][0]["location"][1], -1.25);
  EXPECT_NEAR(holo["agents"][0]["rotation"][2], 90 - 12, 1e-9);
}

TEST_F(Exchange, TellsWhatCannotGoOut) {
  std::string scene = scene_with("imaging");
  scene.replace(scene.find("lambert_db = -9\n"), 16, "law = \"sediment\"\nsediment = \"rock\"\n");
  scene +=
      "transmit_pattern = \"line\"\ntransmit_pattern_angle = \"elevation\"\ntransmit_aperture_m = "
      "0.005\n[sea_surface]\nheight_m = 20\n";
  folder.write("scene.toml", scene);
  const std::string said = done({"export", name("scene.toml"), "--to", "obj", "-o", name("obj")});
  for (const char* what :
       {"scattering model 'sediment'", "beam patterns", "sea surface", "cannot describe sonars"})
    EXPECT_THAT(said, HasSubstr(what));
  EXPECT_THAT(bytes_of(folder / "obj/README.txt"), HasSubstr("scattering model 'sediment'"));
}

TEST_F(Exchange, PlacesMovingObjectsAtTheExportedPing) {
  std::string scene = scene_with("imaging") + "pings = 3\nping_interval_s = 0.5\ntrajectory = \"sonar\"\n";
  const std::string trajectory = "[trajectory]\n", heading = "heading_deg = 33\n";
  scene.replace(scene.find(heading), heading.size(), heading + "trajectory = \"path\"\n");
  scene.replace(
      scene.find(trajectory), trajectory.size(),
      "[[trajectories]]\nname = \"path\"\nkind = \"line\"\nstart_m = [-1, 0, 0]\nend_m = [3, 0, 0]\n"
      "speed_m_s = 0.5\n[[trajectories]]\nname = \"sonar\"\n");
  folder.write("scene.toml", scene);
  const auto survey = open_survey(read_scene_file(folder / "scene.toml"));
  const ExchangedScene first = exchanged_scene(*survey, {}, 0), last = exchanged_scene(*survey, {}, 2);
  ASSERT_EQ(first.pieces.size(), last.pieces.size());
  for (std::size_t k = 0; k < first.pieces.size(); ++k) {
    const ExchangedPiece &before = first.pieces[k], &after = last.pieces[k];
    ASSERT_EQ(before.points_m.size(), after.points_m.size());
    // The time between the pings is 1 s. The object moves by a vector of the grid.
    const glm::dvec3 moved{before.name == "a box" ? 0.5 : 0.0, 0, 0};
    for (std::size_t v = 0; v < before.points_m.size(); ++v)
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(after.points_m[v][axis], before.points_m[v][axis] + moved[axis], 1e-12) << before.name;
  }
  // Objects have one place per export, also if the pings of two sensors differ.
  folder.write("late.toml",
               scene + "[[sensors]]\nname = \"late\"\ntrajectory = \"sonar\"\nfirst_ping_s = 0.25\n" +
                   sonars.at("imaging"));
  EXPECT_THAT(
      done({"export", name("late.toml"), "--to", "obj", "-o", name("both")}),
      HasSubstr("left out: the places of moving objects at the pings of other sensors; they are at 0 s"));
  EXPECT_THAT(done({"export", name("late.toml"), "--to", "obj", "--sensor", "late", "-o", name("one")}),
              Not(HasSubstr("moving objects")));
}

TEST_F(Exchange, RefusesPingsAndSensorsThatAreNotThere) {
  folder.write("scene.toml", scene_with("imaging"));
  const Outcome ping =
      run_program({"export", name("scene.toml"), "--to", "obj", "--pings", "1", "-o", name("obj")});
  EXPECT_EQ(ping.exit_code, 2);
  EXPECT_THAT(ping.err, HasSubstr("pings 0 to 0"));
  EXPECT_EQ(run_program({"export", name("scene.toml"), "--to", "obj", "--sensor", "x", "-o", name("obj")})
                .exit_code,
            2);
  EXPECT_FALSE(fs::exists(folder / "obj"));
}

}  // namespace
}  // namespace tubefoot
