// SPDX-License-Identifier: GPL-3.0-or-later
// Tests invalid input: the program reports position and error, exits with 2 and writes nothing. For unusual
// but valid input it reports a warning, and the run succeeds.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

struct BadInput : testing::Test {
  TestFolder folder;
  BadInput() {
    folder.write("scene.toml", small_scene);
    folder.write("thing.obj", tetrahedron);
  }

  Outcome run(const std::string& scene = "scene.toml") const {
    return run_program({"run", (folder / scene).string(), "-o", (folder / "results").string()});
  }
  /// `message` may use paths relative to the folder.
  void expect_refused(const std::string& message, const std::string& scene = "scene.toml") const {
    const auto before = names_below(folder.path());
    Outcome outcome = run(scene);
    EXPECT_EQ(outcome.exit_code, 2) << "signal " << outcome.signal << " " << outcome.out;
    const std::string prefix = folder.path().string() + "/";
    for (std::size_t at; (at = outcome.err.find(prefix)) != std::string::npos;)
      outcome.err.erase(at, prefix.size());
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_EQ(names_below(folder.path()), before);
  }
  void expect_scene_refused(std::string_view from, std::string_view to, const std::string& message) const {
    SCOPED_TRACE(to);
    folder.write("scene.toml", replaced(small_scene, from, to));
    expect_refused(message);
  }
  void expect_mesh_refused(std::string_view mesh, const std::string& message) const {
    SCOPED_TRACE(mesh.substr(0, 200));
    folder.write("thing.obj", mesh);
    expect_refused(message);
  }
};

TEST_F(BadInput, SceneFileThatIsNone) {
  expect_refused("missing.toml: there is no such scene file", "missing.toml");
  folder.write("scene.toml", "");
  expect_refused("scene.toml: the scene has no terrain and no object: add [[terrain]] or [[objects]]");
  folder.write("scene.toml", "[[materials]\n");
  expect_refused("scene.toml:1:");
  folder.write("scene.toml", std::string("\x7f"
                                         "ELF\0\1\2\3",
                                         8));
  expect_refused("scene.toml:1:1: not valid TOML");
  fs::create_directory(folder / "folder.toml");
  expect_refused("folder.toml: is a folder, expected a scene file", "folder.toml");
}

TEST_F(BadInput, MisspeltKeyIsPlacedAndCorrected) {
  expect_scene_refused("tilt_deg", "tild_deg",
                       "scene.toml:20:1: unknown key 'tild_deg' in [[sensors]]: did you mean 'tilt_deg'?");
  expect_scene_refused("width_m = 20", "width_m = \"20\"", "scene.toml:6:11: ");
  expect_scene_refused("tilt_deg", "tilt_rad",
                       "scene.toml:20:1: unknown key 'tilt_rad' in [[sensors]]: give it in "
                       "degrees, as 'tilt_deg'");
}

TEST_F(BadInput, MissingMesh) {
  expect_scene_refused("thing.obj", "thong.obj", "scene.toml:11:8: 'file': there is no file 'thong.obj'");
}

TEST_F(BadInput, BrokenMesh) {
  const std::string place = "scene.toml:8:1: thing.obj";
  expect_mesh_refused("", place + ": is empty");
  expect_mesh_refused(tetrahedron.substr(0, 50),
                      place + ":7: the last face has 0 corners, and its line does not end with a newline");
  expect_mesh_refused(tetrahedron.substr(0, 29), place + ":4:");
  expect_mesh_refused(tetrahedron.substr(0, tetrahedron.find('f')),
                      place + ": holds 4 points and no facets: it is a point cloud");
  expect_mesh_refused(
      replaced(tetrahedron, "f 3 1 4", "f 3 1 5"),
      place + ":8: the face refers to vertex 5, which is out of range: the file holds 4 vertices");
  expect_mesh_refused(replaced(tetrahedron, "f 3 1 4", "f 3 0 4"), place + ":8");
  expect_mesh_refused(replaced(tetrahedron, "f 3 1 4", "f 3 -9 4"), place + ":8");
  for (const std::string number : {"nan", "-inf", "1e999"})
    expect_mesh_refused(replaced(tetrahedron, "v 0 4 0", "v 0 " + number + " 0"),
                        place + ":3:5: the vertex's y is '" + number + "', expected a finite number");
  expect_mesh_refused(replaced(tetrahedron, "v 0 4 0", "v 0 4e12 0"), "is too large");
}

// Each prefix of a file is a truncated file. The program rejects it, unless its last line is complete and
// it is a valid mesh.
TEST_F(BadInput, MeshCutOffAnywhereNeverCrashes) {
  for (std::size_t length = 0; length < tetrahedron.size(); length += 7) {
    SCOPED_TRACE(length);
    folder.write("thing.obj", tetrahedron.substr(0, length));
    const Outcome outcome = run_program({"audit", (folder / "scene.toml").string(), "--quiet"});
    EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 2) << "signal " << outcome.signal;
    if (outcome.exit_code == 2) {
      EXPECT_THAT(outcome.err, HasSubstr("thing.obj"));
    }
  }
}

TEST_F(BadInput, SectorThatIsNone) {
  for (const char* width : {"0", "-3", "180", "400"})
    expect_scene_refused(
        "horizontal_deg = 4", fmt::format("horizontal_deg = {}", width),
        "scene.toml:19:18: 'horizontal_deg' must be > 0, < 180 degrees, not " + std::string(width));
  expect_scene_refused("horizontal_deg = 4", "vertical_deg = 171", "'vertical_deg' must be > 0, <= 170");
  expect_scene_refused("horizontal_deg = 4", "vertical_deg = nan", "'vertical_deg'");
}

TEST_F(BadInput, SensorBelowTheSeabed) {
  expect_scene_refused("position_m = [0, 0, 2]", "position_m = [0, 0, -1]",
                       "scene.toml:15:1: sensor 'camera' is 1 m below the seabed ('terrain') at ping 0");
}

TEST_F(BadInput, CoordinatesBeyondTheGrid) {
  expect_scene_refused("position_m = [0, 0, 2]", "position_m = [0, 0, 1e11]",
                       "must be -10000000 to 10000000");
  // Both factors are in range, but their product is not.
  folder.write("thing.obj", replaced(tetrahedron, "v 0 4 0", "v 0 4e6 0"));
  expect_scene_refused("file = \"thing.obj\"", "file = \"thing.obj\"\nscale = [1, 1e6, 1]\n",
                       "'thing' reaches 4e+12 m from the frame's origin");
}

constexpr std::string_view raster_scene = R"([georeference]
crs = "EPSG:32602"
origin_crs = [621930, 7245100]
[[materials]]
name = "sand"
[[terrain]]
kind = "raster"
file = "grid.asc"
[trajectory]
kind = "fixed"
position_m = [0, 0, 100]
[[sensors]]
name = "camera"
kind = "didson"
)";

TEST_F(BadInput, RasterWithoutAFrameInAGeoreferencedScene) {
  folder.write("scene.toml", raster_scene);
  folder.write("grid.asc", "ncols 2\nnrows 2\nxllcorner 621929\nyllcorner 7245099\ncellsize 1\n1 1\n1 1\n");
  expect_refused("has no coordinate reference system, but the scene's frame is georeferenced");
}

TEST_F(BadInput, RasterThatIsNone) {
  folder.write("scene.toml", raster_scene);
  folder.write("grid.asc", "these are no numbers\n");
  expect_refused("grid.asc");
  folder.write("grid.asc", "");
  expect_refused("grid.asc");
}

TEST_F(BadInput, TruncatedBag) {
  const fs::path bag = TUBEFOOT_SOURCE_DIR "/scenes/data/jd211.bag";
  folder.write("scene.toml", replaced(raster_scene, "grid.asc", "grid.bag"));
  const std::string whole = bytes_of(bag);
  for (const double share : {0.0003, 0.01, 0.5, 0.99, 0.99999}) {
    SCOPED_TRACE(share);
    folder.write("grid.bag", std::string_view(whole).substr(
                                 0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))));
    expect_refused("grid.bag");
  }
}

TEST_F(BadInput, FacetsWithoutAreaAndDuplicatesAreKeptWithAWarning) {
  folder.write("thing.obj", std::string(tetrahedron) + "f 1 3 2\nf 2 2 3\nf 4 4 4\n");
  const Outcome outcome = run();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("warning: 2 facets have no area on the grid"));
  EXPECT_THAT(outcome.err, HasSubstr("warning: 1 facets coincide with an earlier facet"));
  const Outcome check = run_program({"check", (folder / "scene.toml").string()});
  EXPECT_THAT(check.out, HasSubstr("facets         9 (2 degenerate, 1 duplicate, "));
  const Outcome audit = run_program({"audit", (folder / "scene.toml").string()});
  EXPECT_EQ(audit.exit_code, 0);
  folder.write("thing.obj", tetrahedron);
  const Outcome clean = run_program({"audit", (folder / "scene.toml").string()});
  EXPECT_EQ(audit.out, clean.out) << "what is visible is the same, the hash included";
}

TEST_F(BadInput, SensorInsideAnObjectIsAWarning) {
  folder.write("scene.toml",
               std::string(small_scene) +
                   "[[objects]]\nname = \"housing\"\nshape = \"box\"\nposition_m = [0, 0, 2]\n");
  const Outcome outcome = run();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("sensor 'camera' is inside object 'housing' at ping 0"));
}

TEST_F(BadInput, NothingInViewIsAWarning) {
  folder.write("scene.toml", replaced(small_scene, "tilt_deg = 30", "tilt_deg = -60"));
  const Outcome outcome = run();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("warning: "));
  EXPECT_THAT(outcome.err, HasSubstr("sensor 'camera' receives nothing"));
  EXPECT_EQ(read_echoes(folder / "results" / "echoes.nc").total(), 0);
}

}  // namespace
}  // namespace tubefoot
