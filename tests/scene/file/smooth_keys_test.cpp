// SPDX-License-Identifier: GPL-3.0-or-later
// Tests smooth materials: their keys, and the surfaces that loading makes of them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/scattering/reflection.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "scene/scene.hpp"
#include "scene/surfaces/smooth_materials.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::optional<SmoothSurface> surface_with(std::string_view keys) {
  const TestFolder folder;
  std::vector<std::string> warnings;
  return load_smooth_surfaces(read_scene(folder, scene_with_sand(keys)), warnings).at(0);
}

std::string error_with(std::string_view keys) {
  try {
    surface_with(keys);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(SmoothKeys, AllAreRead) {
  EXPECT_FALSE(surface_with(""));
  EXPECT_FALSE(surface_with("smooth = false"));
  const auto rigid = surface_with("smooth = true");
  ASSERT_TRUE(rigid);
  EXPECT_EQ(rigid->reflection, 1.0);
  EXPECT_EQ(rigid->roughness_m, 0);
  EXPECT_FALSE(rigid->fluid);
  const auto soft = surface_with("smooth = true\nreflection = -0.75\nroughness_m = 2e-3");
  EXPECT_EQ(soft->reflection, -0.75);
  EXPECT_EQ(soft->roughness_m, 2e-3);
  EXPECT_EQ(soft->factor(0.5, 300), -0.75 * std::exp(-0.5 * 0.6 * 0.6));
  const auto fluid = surface_with("smooth = true\nfluid = [2, 1.15, 0.9]");
  EXPECT_EQ(fluid->factor(0.6, 300), reflection_coefficient(fluid_sediment(2, 1.15, 0.9), std::asin(0.6)));
  const auto grains = surface_with("smooth = true\ngrain_size_phi = 2.5");
  EXPECT_EQ(grains->factor(0.6, 300), reflection_coefficient(sediment_of_grain_size(2.5), std::asin(0.6)));
}

TEST(SmoothKeys, OnesThatDoNotGoTogetherAreRefused) {
  for (const char* key :
       {"reflection = 0.5", "fluid = [2, 1, 0]", "grain_size_phi = 1", "roughness_m = 0.1"}) {
    const std::string name = std::string(key).substr(0, std::string_view(key).find(' '));
    EXPECT_THAT(error_with(key),
                HasSubstr(fmt::format("scene.toml:3:{}: '{}' applies only with smooth = true: add",
                                      name.size() + 4, name)));
    EXPECT_THAT(error_with(fmt::format("smooth = false\n{}", key)),
                HasSubstr("applies only with smooth = true"));
  }
  EXPECT_THAT(
      error_with("smooth = true\nreflection = 1\nfluid = [2, 1, 0]"),
      HasSubstr("scene.toml:5:9: 'reflection' and 'fluid' both define the reflection of the material"));
  EXPECT_THAT(error_with("smooth = true\nfluid = [2, 1, 0]\ngrain_size_phi = 1"),
              HasSubstr("'fluid' and 'grain_size_phi' both define"));
  EXPECT_THAT(error_with("smooth = true\nreflection = 1.1"), HasSubstr("must be -1 to 1, not 1.1"));
  EXPECT_THAT(error_with("smooth = true\nroughness_m = -1"), HasSubstr("must be 0 to 10"));
  EXPECT_THAT(error_with("smooth = true\nfluid = [0, 1, 0]"), HasSubstr("must be 0.01 to 100"));
  EXPECT_THAT(error_with("smooth = true\ngrain_size_phi = 10"), HasSubstr("must be -1 to 9"));
  EXPECT_THAT(error_with("smooth = 1"), HasSubstr("true or false"));
}

// Energies do not depend on this key: the scene warns once.
TEST(SmoothKeys, AreWarnedOfWhereNobodyReceivesPhases) {
  const TestFolder folder;
  const Scene scene = load_scene(read_scene(folder, scene_with_sand("smooth = true")));
  ASSERT_NE(scene.smooth_surface(0), nullptr);
  EXPECT_THAT(scene.report.warnings, ElementsAre("material 'sand' is smooth, but no sensor records signals: "
                                                 "its energies follow its scattering model"));
  const Scene scattered =
      load_scene(read_scene(folder, std::string(smallest_scene) + "\n[scatterers]\nspacing_m = 0.1\n"));
  EXPECT_THAT(scattered.report.warnings,
              ElementsAre(AllOf(HasSubstr("scene.toml:"),
                                HasSubstr("[scatterers] has no effect, because no sensor records signals"))));
  const Scene rough = load_scene(read_scene(folder, smallest_scene));
  EXPECT_EQ(rough.smooth_surface(0), nullptr);
  EXPECT_TRUE(rough.report.warnings.empty());
}

}  // namespace
}  // namespace tubefoot
