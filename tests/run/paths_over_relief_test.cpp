// SPDX-License-Identifier: GPL-3.0-or-later
// Tests paths over mirrors with relief that each transmission refines for itself. The comparison is relief
// on the whole seabed.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

constexpr std::string_view ripples =
    "[[materials.relief]]\nkind = \"ripples\"\ntile_m = 12.8\nresolution_m = 0.1\nseed = 7\n"
    "wavelength_m = 1.6\ndirection_deg = 20\nrms_height_m = 0.06\n";

/// The sonar is 2 m below the surface and 4 m above a rippled seabed, in view of a tilted plate. The plate
/// reflects parts of the seabed that the sonar does not look at.
std::string scene(std::string_view relief, std::string_view paths, std::string_view plate_relief = {},
                  std::string_view more = {}) {
  return still_water() + fmt::format("[sea_surface]\nloss_db = 1\n[paths]\n{}\n", paths) +
         lambert_material("bed", -12) + std::string(ripples) + lambert_material("steel", -20) +
         "specular_loss_db = 3\n" + std::string(plate_relief) +
         flat_terrain(26, 26, "centre_m = [0, 0, -4]\n") + "material = \"bed\"\n" +
         "[[objects]]\nname = \"plate\"\nshape = \"box\"\nmaterial = \"steel\"\nsize_m = [2, 0.2, 2]\n"
         "position_m = [0.4, 5, -2.6]\nheading_deg = 30\npitch_deg = 12\n" +
         fmt::format("[relief]\ncell_m = 0.4\n{}\n", relief) + fixed_at(0, 0, -2) + R"([[sensors]]
name = "ahead"
kind = "imaging"
beams = 3
horizontal_deg = 24
vertical_deg = 70
tilt_deg = 0
range_min_m = 3
range_max_m = 11
samples = 40
)" + std::string(more);
}

/// Compares with a tolerance relative to the largest bin, because rounding changes slivers of range gates.
void expect_equal(const Echoes& a, const Echoes& b, double relative) {
  ASSERT_EQ(a.energy.size(), b.energy.size());
  const double most = *std::ranges::max_element(b.energy);
  ASSERT_GT(most, 0);
  for (std::size_t k = 0; k < a.energy.size(); ++k)
    EXPECT_NEAR(a.energy[k], b.energy[k], relative * b.energy[k] + 1e-3 * relative * most) << k;
}

constexpr std::string_view online = "mode = \"online\"\ntolerance = 0", offline = "mode = \"offline\"";

TEST(PathsOverRelief, CellsEverywhereAreTheReliefOfTheWholeSeabed) {
  for (const int order : {2, 3}) {
    // Only paths over mirrors.
    const std::string paths = fmt::format("order = {0}\nonly_order = {0}", order);
    expect_equal(echoes_of(scene(online, paths)), echoes_of(scene(offline, paths)), 1e-9);
  }
}

TEST(PathsOverRelief, ASeparateReceiverHasImagesOfItsOwn) {
  const std::string paths = "order = 3\nonly_order = 3", apart = "receiver_arm_m = [1.5, 0.5, 0.4]\n";
  expect_equal(echoes_of(scene(online, paths, {}, apart)), echoes_of(scene(offline, paths, {}, apart)), 1e-9);
}

// The relief of the plate turns it into many small mirrors, each with its image.
TEST(PathsOverRelief, AMirrorWithReliefIsManyMirrors) {
  for (const std::string_view displace : {"\ndisplace = \"vertical\"", "\ndisplace = \"normal\""}) {
    const std::string paths = "order = 2\nonly_order = 2", coarse(displace);
    const auto echoes = [&](std::string_view how) {
      return echoes_of(scene(std::string(how) + coarse, paths, ripples));
    };
    const Echoes refined = echoes(online);
    expect_equal(refined, echoes(offline), 1e-9);
    const Echoes even = echoes_of(scene(std::string(offline) + coarse, paths));
    // the echo differs from that of the plane plate
    EXPECT_GT(std::abs(refined.total() / even.total() - 1), 1e-3);
  }
  const TestFolder folder;
  const auto file = folder.write("scene.toml", scene(online, "order = 2\nmost_images = 20", ripples));
  const Outcome outcome = run_program({"run", file.string(), "-o", (folder / "out").string()});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, testing::HasSubstr("more than 20 images"));
}

// Paths with two scatterings come from directions without tubes.
TEST(PathsOverRelief, SeveralScatteringsMeetReliefAllRound) {
  const std::string paths = "order = 3\nscatterings = 3\npatch_m = 3\nonly_order = 3";
  const auto echoes = [&](std::string_view how) {
    return echoes_of(replaced(replaced(scene(how, paths), "cell_m = 0.4", "cell_m = 2"), "range_max_m = 11",
                              "range_max_m = 5"));
  };
  const Echoes whole = echoes(offline);
  expect_equal(echoes("mode = \"online\"\ntolerance = 0"), whole, 1e-9);
}

// Relief is coarser where this changes a range bin by less than the tolerance.
TEST(PathsOverRelief, CoarserReliefKeepsTheTolerance) {
  const std::string paths = "order = 3\nonly_order = 2";
  const auto echoes = [&](std::string_view how) {
    return echoes_of(replaced(scene(how, paths), "rms_height_m = 0.06", "rms_height_m = 0.01"));
  };
  const Echoes whole = echoes(offline), coarser = echoes("mode = \"online\"\ntolerance = 0.6");
  double squares = 0, weight = 0;
  for (std::size_t k = 0; k < whole.energy.size(); ++k) {
    squares += std::pow(coarser.energy[k] - whole.energy[k], 2);
    weight += whole.energy[k] * whole.energy[k];
  }
  EXPECT_LT(std::sqrt(squares / weight), 0.6);
  EXPECT_GT(std::sqrt(squares / weight), 0.01);
}

// A sand bank that rises above the water ends at the surface, as in offline mode.
TEST(PathsOverRelief, ReliefEndsAtTheSurface) {
  const std::string paths = "order = 2";
  const auto echoes = [&](std::string_view how) {
    return echoes_of(replaced(replaced(scene(how, paths), "size_m = [2, 0.2, 2]", "size_m = [9, 2, 9]"),
                              "position_m = [0.4, 5, -2.6]", "position_m = [0.4, 7, -1]"));
  };
  expect_equal(echoes(online), echoes(offline), 1e-9);
}

}  // namespace
}  // namespace tubefoot
