// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the keys of relief in scene files: their order, errors with positions, and the relief of each
// material after loading.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/world/read_scenes.hpp"
#include "scene/scene.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// The smallest scene with these additional lines in its material.
std::string with_relief(std::string_view lines) {
  return replaced(smallest_scene, "name = \"sand\"\n", "name = \"sand\"\n" + std::string(lines));
}

TEST(ReliefKeys, AreReadInTheirOrder) {
  const TestFolder folder;
  folder.write("map.tif", "II*");
  const SceneDescription scene = read_scene(folder, with_relief(R"([[materials.relief]]
kind = "fbm"
hurst = 0.7
rms_height_m = 0.2
tile_m = 12
resolution_m = 0.04
seed = 9
[[materials.relief]]
kind = "fbm"
spectral_exponent = 3.25
spectral_strength_cm4 = 0.004446
tile_m = 10
resolution_m = 0.02
[[materials.relief]]
kind = "ripples"
wavelength_m = 0.3
direction_deg = -60
rms_height_m = 0.01
hurst = 0.8
tile_m = 15
resolution_m = 0.03
seed = 4
[[materials.relief]]
kind = "map"
file = "map.tif"
tile_m = 7
scale = -2
)"));
  ASSERT_EQ(scene.materials.size(), 1u);
  const std::vector<ReliefDescription>& relief = scene.materials[0].relief;
  ASSERT_EQ(relief.size(), 4u);
  EXPECT_EQ(to_string(relief[0].place), (folder.path() / "scene.toml").string() + ":3:1");
  EXPECT_EQ(relief[0].tile_m, 12);
  EXPECT_EQ(relief[0].resolution_m, 0.04);
  EXPECT_EQ(relief[0].seed, 9u);
  EXPECT_EQ(std::get<FractalReliefDescription>(relief[0].kind), (FractalReliefDescription{0.7, {}, 0.2, {}}));
  EXPECT_EQ(relief[1].seed, 1u);
  EXPECT_EQ(std::get<FractalReliefDescription>(relief[1].kind),
            (FractalReliefDescription{{}, 3.25, {}, 0.004446}));
  EXPECT_EQ(relief[2].tile_m, 15);
  EXPECT_EQ(std::get<RippleReliefDescription>(relief[2].kind),
            (RippleReliefDescription{0.3, -60, 0.01, 0.8}));
  EXPECT_EQ(std::get<MapReliefDescription>(relief[3].kind),
            (MapReliefDescription{folder.path() / "map.tif", 7, -2}));
}

TEST(ReliefKeys, MistakesAreReportedWithTheirPlace) {
  const TestFolder folder;
  const std::string fbm = "[[materials.relief]]\nkind = \"fbm\"\ntile_m = 10\nresolution_m = 0.1\n";
  const struct {
    std::string lines, begin, has;
  } cases[] = {
      {fbm + "hurst = 0.8\n", "scene.toml:3:1: ", "'rms_height_m' or 'spectral_strength_cm4'"},
      {fbm + "rms_height_m = 0.8\n", "scene.toml:3:1: ", "'hurst' or 'spectral_exponent'"},
      {fbm + "rms_height_m = 0.1\nhurst = 0.8\nspectral_exponent = 3\n", "scene.toml:9:21: ", "only one"},
      {fbm + "hurst = 0.8\nspectral_strength_cm4 = 1\nrms_height_m = 0.1\n", "scene.toml:8:25: ", "only one"},
      {fbm + "hurst = 1.5\nrms_height_m = 0.1\n", "scene.toml:7:9: ", "0 to 1"},
      {fbm + "wavelength_m = 1\n", "scene.toml:7:1: ", "kind = \"ripples\""},
      {fbm + "hurts = 0.5\n", "scene.toml:7:1: ", "did you mean 'hurst'?"},
      {"[[materials.relief]]\nkind = \"fbm\"\ntile_m = 10\n", "scene.toml:3:1: ", "'resolution_m'"},
      {"[[materials.relief]]\nkind = \"ripple\"\n", "scene.toml:4:8: ", "did you mean \"ripples\"?"},
      {"[[materials.relief]]\nkind = \"map\"\nfile = \"no.tif\"\n", "scene.toml:5:8: ", "there is no file"},
      {"relief = 3\n", "scene.toml:3:10: ", "[[materials.relief]]"},
      {"relief = [3]\n", "scene.toml:3:11: ", "[[materials.relief]]"},
      {"[[materials.releif]]\n", "scene.toml:3:", "did you mean 'relief'?"},
  };
  for (const auto& [lines, begin, has] : cases) {
    const std::string message = scene_error(folder, with_relief(lines));
    EXPECT_THAT(message, StartsWith(begin)) << lines;
    EXPECT_THAT(message, HasSubstr(has)) << lines;
  }
}

TEST(ReliefKeys, ASingleEntryMayBeOneTable) {
  const TestFolder folder;
  const SceneDescription scene = read_scene(
      folder,
      with_relief(
          "relief = {kind = \"fbm\", hurst = 0.5, rms_height_m = 1, tile_m = 10, resolution_m = 1}\n"));
  EXPECT_EQ(scene.materials[0].relief.size(), 1u);
}

TEST(ReliefKeys, SceneHasTheFieldOfEveryMaterial) {
  const TestFolder folder;
  const std::string rock =
      "[[materials.relief]]\nkind = \"fbm\"\nhurst = 0.8\nrms_height_m = 0.1\ntile_m = 10\nresolution_m = "
      "0.1\n";
  const std::string ripples =
      "[[materials.relief]]\nkind = \"ripples\"\nwavelength_m = 1\nrms_height_m = 0.02\ntile_m = 10\n"
      "resolution_m = 0.1\n";
  const std::string scene = rock + "[[materials]]\nname = \"flat\"\n[[materials]]\nname = \"rock\"\n" + rock +
                            "[[materials]]\nname = \"both\"\n" + rock + ripples +
                            "[[materials]]\nname = \"sand 2\"\n" +
                            replaced(rock, "hurst = 0.8", "spectral_exponent = 3.6");
  const Scene loaded = load_scene(
      read_scene(folder, replaced(with_relief(scene), "width_m = 20", "width_m = 20\nmaterial = \"sand\"")));
  ASSERT_EQ(loaded.relief.size(), 5u);
  EXPECT_EQ(loaded.relief[1], nullptr);
  ASSERT_NE(loaded.relief[0], nullptr);
  EXPECT_EQ(loaded.relief[0], loaded.relief[2]) << "made once";
  const glm::dvec3 place(3.21, -7.65, 0);
  const double height = loaded.relief[0]->height_m(place);
  EXPECT_NE(height, 0);
  EXPECT_LE(std::abs(height), loaded.relief[0]->largest_m());
  EXPECT_NEAR(loaded.relief[4]->height_m(place), height, 1e-6) << "exponent 3.6 is Hurst 0.8";
  const double both = loaded.relief[3]->height_m(place);
  EXPECT_NE(both, height);
  EXPECT_LE(std::abs(both - height), 0.02 * 6);
}

TEST(ReliefKeys, WhatCannotBeMadeIsReportedAtItsEntry) {
  const TestFolder folder;
  const auto error_of = [&](const std::string& lines) -> std::string {
    const SceneDescription scene = read_scene(folder, with_relief(lines));
    try {
      load_scene(scene);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  const std::string many = error_of(
      "\n[[materials.relief]]\nkind = \"fbm\"\nhurst = 0.8\nrms_height_m = 0.1\ntile_m = 1000\n"
      "resolution_m = 0.01\n");
  EXPECT_THAT(many, HasSubstr("scene.toml:4:1: "));
  EXPECT_THAT(many, testing::AllOf(HasSubstr("100000"), HasSubstr("16384")));
  const std::string ripples = error_of(
      "[[materials.relief]]\nkind = \"ripples\"\nwavelength_m = 0.3\nrms_height_m = 0.1\ntile_m = 10\n"
      "resolution_m = 0.1\n");
  EXPECT_THAT(ripples, HasSubstr("scene.toml:3:1: "));
  EXPECT_THAT(ripples, HasSubstr("0.075"));
}

}  // namespace
}  // namespace tubefoot
