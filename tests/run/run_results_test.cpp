// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the results of a run: attributes of echo files, statistics and pictures, and the same bytes in each
// run of the same scene.
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// A camera and a sidescan over the tetrahedron.
const std::string results_scene =
    std::string(small_scene) +
    "[[sensors]]\nname = \"side\"\nkind = \"sidescan\"\npings = 5\nsamples = 100\n"
    "range_max_m = 12\nalong_track_deg = 2\n"
    "[georeference]\norigin_lat_lon_deg = [48, -4]\n";

struct RunResults : testing::Test {
  TestFolder folder;
  const fs::path results = folder / "results";
  RunResults() { folder.write("thing.obj", tetrahedron); }
  Echoes run(const std::vector<std::string>& arguments = {}) const {
    return echoes_in(folder, results_scene, arguments, "camera");
  }
};

TEST_F(RunResults, EchoesSayWhatComputedThem) {
  for (const std::string arithmetic : {"fixed", "filtered"}) {
    run({"--arithmetic", arithmetic});
    const fs::path file = results / "echoes.nc";
    EXPECT_EQ(read_echo_file(file).provenance.title, "A tetrahedron");
    EXPECT_EQ(read_echo_file(file).provenance.engine, "tube");
    EXPECT_EQ(read_echo_file(file).provenance.arithmetic, arithmetic);
    EXPECT_THAT(run_program({"--version"}).out,
                testing::StartsWith("tubefoot " + read_echo_file(file).provenance.version + "\n"));
    EXPECT_THAT(read_echo_file(file).provenance.scene_hash, testing::MatchesRegex("[0-9a-f]+"));
    EXPECT_EQ(read_echo_file(file).provenance.scene_hash.size(), 64u);
  }
}

TEST_F(RunResults, SceneHashFollowsTheSceneAndItsFiles) {
  run();
  const std::string first = read_echo_file(results / "echoes.nc").provenance.scene_hash;
  folder.write("thing.obj", std::string(tetrahedron) + "# a remark\n");
  run();
  EXPECT_NE(read_echo_file(results / "echoes.nc").provenance.scene_hash, first);
}

TEST_F(RunResults, EnergyHasThePlaceItsDimensionsSay) {
  const Echoes camera = run();
  EXPECT_EQ(camera.pings, 1u);
  EXPECT_EQ(camera.beams, 4u);
  EXPECT_EQ(camera.samples, 512u);
  const Echoes side = read_echoes(results / "echoes.nc", "side");
  EXPECT_EQ(side.pings, 5u);
  EXPECT_EQ(side.beams, 2u);
  EXPECT_EQ(side.samples, 100u);
  EXPECT_DOUBLE_EQ(side.first_m(0), 0.5);
  EXPECT_DOUBLE_EQ(side.last_m(99), 12);
  EXPECT_GT(camera.total(), 0);
  EXPECT_GT(side.total(), 0);
}

TEST_F(RunResults, StatisticsCountAndMeasure) {
  run({"--threads", "1"});
  const auto stats = nlohmann::json::parse(bytes_of(results / "stats.json"));
  EXPECT_EQ(stats["facets"], 6);
  EXPECT_EQ(stats["pings"], 6);
  EXPECT_EQ(stats["threads"], 1);
  EXPECT_EQ(stats["engine"], "tube");
  EXPECT_EQ(stats["arithmetic"], "fixed");
  EXPECT_EQ(stats["scene_hash"], read_echo_file(results / "echoes.nc").provenance.scene_hash);
  EXPECT_GT(stats["tubes"], 4);
  EXPECT_GT(stats["candidates"], 0);
  EXPECT_GT(stats["footprints"], 4);
  EXPECT_GE(stats["pieces"], stats["footprints"]);
  EXPECT_GT(stats["peak_memory_mb"], 1);
  ASSERT_EQ(stats["warnings"].size(), 2);
  EXPECT_THAT(stats["warnings"][0].get<std::string>(),
              testing::StartsWith("no DIDSON or ARIS file is written for 'camera'"));
  EXPECT_THAT(stats["warnings"][1].get<std::string>(),
              testing::StartsWith("side-mosaic.tif is not written: the sensor is at rest"));
  for (const char* stage : {"load", "tree", "simulation", "write", "total"})
    EXPECT_GE(stats["seconds"][stage], 0) << stage;
  EXPECT_GE(stats["seconds"]["total"], stats["seconds"]["simulation"]);
}

TEST_F(RunResults, PicturesAreEightBitAndMeasurementsAreFloat) {
  run();
  for (const char* name : {"camera-0000.png", "side.png"}) {
    const auto image = OIIO::ImageInput::open((results / name).string());
    ASSERT_TRUE(image) << name;
    EXPECT_EQ(image->spec().format, OIIO::TypeDesc::UINT8);
    EXPECT_EQ(image->spec().nchannels, 3);
    EXPECT_GT(image->spec().width, 100);
    EXPECT_GT(image->spec().height, 100);
  }
  const auto camera = OIIO::ImageInput::open((results / "camera-0000.exr").string());
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->spec().format, OIIO::TypeDesc::FLOAT);
  EXPECT_EQ(camera->spec().width, 4);
  EXPECT_EQ(camera->spec().height, 512);
}

TEST_F(RunResults, CameraMeasurementsAreTheEnergies) {
  const Echoes echoes = run();
  const auto image = OIIO::ImageInput::open((results / "camera-0000.exr").string());
  ASSERT_TRUE(image);
  std::vector<float> pixels(echoes.beams * echoes.samples);
  ASSERT_TRUE(image->read_image(0, 0, 0, 1, OIIO::TypeDesc::FLOAT, pixels.data()));
  for (std::size_t beam = 0; beam < echoes.beams; ++beam)
    for (std::size_t k = 0; k < echoes.samples; ++k)
      ASSERT_EQ(pixels[k * echoes.beams + beam], static_cast<float>(echoes.at(0, beam, k)));
}

TEST_F(RunResults, EqualRunsGiveEqualBytes) {
  const auto bytes = [&](const std::vector<std::string>& arguments) {
    run(arguments);
    std::map<std::string, std::string> files;
    for (const std::string& name : names_below(results))
      if (name != "stats.json") files[name] = bytes_of(results / name);
    return files;
  };
  const auto once = bytes({});
  std::vector<std::string> names;
  for (const auto& [name, content] : once) names.push_back(name);
  EXPECT_THAT(names,
              testing::ElementsAre(".tubefoot-files", "camera-0000.exr", "camera-0000.png", "echoes.nc",
                                   "scene.png", "side-waterfall.png", "side.exr", "side.png", "side.xtf"));
  EXPECT_TRUE(once == bytes({}));
  EXPECT_TRUE(once == bytes({"--threads", "1"}));
}

}  // namespace
}  // namespace tubefoot
