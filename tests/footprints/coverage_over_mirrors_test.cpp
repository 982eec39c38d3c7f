// SPDX-License-Identifier: GPL-3.0-or-later
// Tests `tubefoot coverage` over mirrors. The comparison is sonars at the positions of the images, in
// scenes without the mirror.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "fixtures/covered.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

struct CoverageOverMirrors : testing::Test {
  TestFolder folder;
  Covered cover(const std::string& text, const std::vector<std::string>& more = {}) {
    return covered(folder, text, more);
  }
  static void expect_near(const Covered& a, const Covered& b, double error) {
    for (const auto* of : {&a, &b})
      for (const auto& [facet, share] : of->seen)
        EXPECT_NEAR(a.seen.contains(facet) ? a.seen.at(facet) : 0,
                    b.seen.contains(facet) ? b.seen.at(facet) : 0, error)
            << "facet " << facet;
    EXPECT_NEAR(a.shadow_m2, b.shadow_m2, error * (1 + b.seen_m2));
  }
};

/// A sidescan that looks upwards as well as downwards, over a seabed with a box, 3 m under an optional
/// surface.
std::string scene_under_surface(const std::string& beginning, double height_m,
                                const std::string& sensor = {}) {
  return beginning + flat_terrain(16, 16, "material = \"sand\"\n") +
         fmt::format(R"([[objects]]
name = "box"
shape = "box"
material = "sand"
position_m = [0.2, 4.2, 0.4]
heading_deg = 20
[trajectory]
kind = "fixed"
position_m = [0.1, -0.2, {}]
heading_deg = 90
[[sensors]]
name = "side"
kind = "sidescan"
along_track_deg = 30
depression_min_deg = -60
depression_max_deg = 60
range_min_m = 2
range_max_m = 11
samples = 20
)",
                     height_m) +
         sensor;
}
std::string surface(int order, const std::string& keys = {}) {
  return fmt::format("[sea_surface]\nheight_m = 6\nloss_db = 1\n[paths]\norder = {}\n{}", order, keys);
}
const std::string even = "[water]\nsound_speed_m_s = 1500\n", sand = "[[materials]]\nname = \"sand\"\n";
std::string gradient(const std::string& per_s) {
  return "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = " + per_s +
         "\nprofile_bottom_m = 30\nsurface_height_m = 6\n";
}

// The mirror image of a sonar 3 m below the surface is a sonar 3 m above it.
TEST_F(CoverageOverMirrors, IsThatOfSonarsAtTheImages) {
  const Covered straight = cover(scene_under_surface(even + sand, 3)),
                apart = cover(scene_under_surface(even + sand, 3, "receiver_arm_m = [0, 0, 6]\n")),
                above = cover(scene_under_surface(even + sand, 9));
  for (const std::string& water : {even, gradient("1e-7")}) {
    SCOPED_TRACE(water);
    const double error = water == even ? 1e-6 : 1e-4;
    const auto of = [&](int order, const std::string& keys) {
      return cover(scene_under_surface(water + surface(order, keys) + sand, 3));
    };
    expect_near(of(3, "only_order = 1\n"), straight, error);
    expect_near(of(2, "only_order = 2\n"), apart, error);
    expect_near(of(3, "only_order = 3\n"), above, error);
    // Together they cover at least as much as each, and at most the sum.
    const Covered all = of(3, "");
    for (const Covered* one : {&straight, &apart, &above})
      for (const auto& [facet, share] : one->seen) EXPECT_GE(all.seen.at(facet), share - error);
    EXPECT_LT(all.seen_m2, straight.seen_m2 + apart.seen_m2 + above.seen_m2);
    EXPECT_GT(all.seen_m2, straight.seen_m2 + 0.1);
  }
}

TEST_F(CoverageOverMirrors, AnOptionSaysHowFarPathsAreFollowed) {
  const std::string mirrored = scene_under_surface(even + surface(3) + sand, 3);
  const Covered all = cover(mirrored), once = cover(mirrored, {"--order", "1"}),
                twice = cover(mirrored, {"--order", "2"});
  expect_near(once, cover(scene_under_surface(even + sand, 3)), 1e-9);
  EXPECT_EQ(cover(mirrored, {"--order", "3"}).table, all.table);
  EXPECT_GT(twice.seen_m2, once.seen_m2 - 1e-9);
  EXPECT_GT(all.seen_m2, twice.seen_m2 + 0.1);
  EXPECT_EQ(cover(mirrored, {"--threads", "1"}).table, all.table);
}

// A wall that is a mirror, and a seabed that extends behind it: the mirror plane cuts facets. The
// comparison has no wall, the image of the sonar, and a seabed that ends at the plane.
TEST_F(CoverageOverMirrors, FacetsThatAMirrorsPlaneCutsEndThere) {
  const auto camera = [](double north_m, double heading_deg) {
    return fmt::format(
        "[trajectory]\nkind = \"fixed\"\nposition_m = [0.1, {}, 3]\nheading_deg = {}\n[[sensors]]\nname = "
        "\"camera\"\nkind = \"didson\"\nbeams = 4\nhorizontal_deg = 12\ntilt_deg = 10\nvertical_deg = 8\n"
        "window_start_m = 2\nwindow_length_m = 28\nsamples = 20\n",
        north_m, heading_deg);
  };
  const auto seabed = [](double south_m, double north_m) {
    return fmt::format(
        "[[terrain]]\nname = \"bed\"\nkind = \"flat\"\nmaterial = \"sand\"\nwidth_m = 24\nlength_m = "
        "{}\ncell_m = "
        "1.7\ncentre_m = [0, {}, 0]\n",
        north_m - south_m, (north_m + south_m) / 2);
  };
  const std::string wall =
      "[[materials]]\nname = \"steel\"\nspecular_loss_db = 2\n[[objects]]\nname = \"wall\"\nshape = \"box\"\n"
      "material = \"steel\"\nsize_m = [20, 1, 12]\nposition_m = [0, 6.5, 0]\n";
  const Covered mirrored = cover("[paths]\norder = 3\nonly_order = 3\n" + sand + wall + seabed(-24, 9) +
                                 camera(0, 0)),
                from_image = cover(sand + seabed(-24, 6) + camera(12, 180));
  EXPECT_NEAR(mirrored.seen_m2, from_image.seen_m2, 1e-5 * from_image.seen_m2);
  EXPECT_GT(mirrored.seen_m2, 10);
}

// Each fan of a sidescan receives only its own transmissions. Coverage excludes sound from one fan to the
// other, over a wall or at a separate receiver.
TEST_F(CoverageOverMirrors, NobodyReceivesWhatOneFanSendsToAnother) {
  const std::string wall =
      "[[materials]]\nname = \"steel\"\nspecular_loss_db = 3\n[[objects]]\nname = \"wall\"\nshape = \"box\"\n"
      "material = \"steel\"\nsize_m = [10, 0.5, 8]\nposition_m = [0, 5, 2]\n";
  const auto text = [](const std::string& beginning, const std::string& sensor) {
    return replaced(
        replaced(scene_under_surface(beginning, 5, sensor), "range_min_m = 2", "range_min_m = 0.2"),
        "range_max_m = 11", "range_max_m = 40");
  };
  for (const auto& [beginning, sensor] :
       {std::pair("[paths]\norder = 2\nonly_order = 2\n" + sand + wall,
                  std::string("depression_max_deg = 90\n")),
        std::pair(sand, std::string("receiver_arm_m = [1.5, 0, 0]\ndepression_max_deg = 90\n"))}) {
    const std::string of_both = replaced(text(beginning, sensor), "depression_max_deg = 60\n", "");
    const Covered all = cover(of_both);
    const auto file = folder / "f.csv";
    const Outcome outcome = run_program({"footprints", folder.write("scene.toml", of_both).string(),
                                         "--sensor", "side", "-o", file.string(), "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    double received_m2 = 0;  // each path once; footprints may overlap
    for (const auto& row : csv_rows(file))
      if (std::stod(row.at("energy_j")) > 0 && row.at("rx_reflections") == "0")
        received_m2 += std::stod(row.at("area_m2"));
    EXPECT_LE(all.seen_m2, received_m2 * (1 + 1e-6)) << beginning;
    EXPECT_GT(all.seen_m2, 0.5 * received_m2) << beginning;
  }
}

// Exact corners are those of paths of order 1. Without this order there are none, and the program reports
// this.
TEST_F(CoverageOverMirrors, ExactCornersOfOtherOrdersAreRefused) {
  const auto file =
      folder.write("scene.toml", scene_under_surface(even + surface(2, "only_order = 2\n") + sand, 3));
  const Outcome outcome =
      run_program({"footprints", file.string(), "--sensor", "side", "-o", (folder / "f.txt").string()});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, testing::HasSubstr("'only_order' excludes paths of order 1"));
  EXPECT_FALSE(std::filesystem::exists(folder / "f.txt"));
}

TEST_F(CoverageOverMirrors, AllAtOnceCloses) {
  const std::string relief =
      "[relief]\ncell_m = 0.8\ntolerance = 0\n[[materials]]\nname = \"sand\"\n[[materials.relief]]\nkind = "
      "\"ripples\"\ntile_m = 10.24\nresolution_m = 0.08\nwavelength_m = 2\nrms_height_m = 0.03\n";
  for (const std::string& water : {even, gradient("0.6")})
    for (const char* sensor : {"", "receiver_arm_m = [0.4, 0.2, 0.3]\n"}) {
      SCOPED_TRACE(water + sensor);
      const std::string all = scene_under_surface(water + surface(3) + relief, 3, sensor);
      const Covered first = cover(all, {"--threads", "1"});
      EXPECT_EQ(cover(all, {"--threads", "3"}).table, first.table);
      EXPECT_GT(first.seen_m2, cover(all, {"--order", "1"}).seen_m2);
    }
}

}  // namespace
}  // namespace tubefoot
