// SPDX-License-Identifier: GPL-3.0-or-later
// Tests `tubefoot coverage` for separate receivers, stratified water, and relief of each ping. The
// comparisons are equivalent scenes.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "fixtures/covered.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

const std::string gentle = "gradient_per_s = 1e-7", steep = "gradient_per_s = 0.6";
std::string water(const std::string& gradient) {
  return "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\n" + gradient +
         "\nprofile_bottom_m = 30\nsurface_height_m = 10\n";
}
const std::string isovelocity_water = "[water]\nsound_speed_m_s = 1500\n";

std::string ripples(double rms_m, const std::string& mode) {
  return fmt::format("[relief]\nmode = \"{}\"\ncell_m = 0.4\n{}", mode,
                     mode == "online" ? "tolerance = 0\n" : "") +
         fmt::format(
             "[[materials]]\nname = \"sand\"\n[[materials.relief]]\nkind = \"ripples\"\ntile_m = 5.12\n"
             "resolution_m = 0.04\nseed = 7\nwavelength_m = 1.25\ndirection_deg = 20\nrms_height_m = {}\n",
             rms_m);
}
const std::string flat_sand = "[[materials]]\nname = \"sand\"\n";

/// Three pings of a camera that passes a box on a seabed of few facets.
std::string camera_scene(const std::string& beginning, const std::string& sensor = {}) {
  return beginning + flat_terrain(16, 16, "material = \"sand\"\n") +
         R"([[objects]]
name = "box"
shape = "box"
material = "sand"
position_m = [0.2, 4.2, 0.4]
heading_deg = 20
[trajectory]
kind = "line"
start_m = [0, -0.3, 3]
end_m = [0.1, 0.3, 3]
speed_m_s = 1
[[sensors]]
name = "camera"
kind = "didson"
pings = 3
ping_interval_s = 0.2
tilt_deg = 30
vertical_deg = 20
beams = 6
horizontal_deg = 24
window_start_m = 3
window_length_m = 5
)" + sensor;
}

struct CoverageLooks : testing::Test {
  TestFolder folder;
  Covered cover(const std::string& text, const std::vector<std::string>& more = {}) {
    Covered all = covered(folder, text, more);
    EXPECT_GT(all.shadow_m2, 0.1);
    return all;
  }
  /// Compares the base facets of the same scene, to `error`.
  static void expect_near(const Covered& a, const Covered& b, double error) {
    for (const auto& [facet, share] : a.seen)
      EXPECT_NEAR(share, b.seen.contains(facet) ? b.seen.at(facet) : 0, error) << "facet " << facet;
    for (const auto& [facet, share] : a.shadow)
      EXPECT_NEAR(share, b.shadow.contains(facet) ? b.shadow.at(facet) : 0, error) << "facet " << facet;
  }
};

std::string arms(const std::string& transmitter, const std::string& receiver) {
  return "lever_arm_m = " + transmitter + "\nreceiver_arm_m = " + receiver + "\n";
}
const std::string one = "[-0.6, 0, 0.2]", other = "[0.7, 0.3, -0.1]";

// After an exchange of transmitter and receiver, pixels are the same parts of the seabed.
TEST_F(CoverageLooks, ASeparateReceiverAndATransmitterAreExchanged) {
  for (const std::string& where : {isovelocity_water + flat_sand, water(steep) + flat_sand,
                                   isovelocity_water + ripples(0.03, "online")}) {
    SCOPED_TRACE(where);
    const Covered there = cover(camera_scene(where, arms(one, other))),
                  back = cover(camera_scene(where, arms(other, one)));
    // Corners of the range gate are rounded on images of the transmitter. The looks determine the relief.
    if (where == isovelocity_water + flat_sand || where == isovelocity_water + ripples(0.03, "online"))
      expect_near(there, back, 1e-6);
    else
      expect_near(there, back, 2e-3);  // ranges use the sound speed at the transmitter
    const Covered of_one = cover(camera_scene(where, "lever_arm_m = " + one + "\n"));
    EXPECT_LT(there.seen_m2, of_one.seen_m2) << "what both see is less";
  }
}

TEST_F(CoverageLooks, AReceiverAHairApartSeesWhatOnePlaceDoes) {
  const Covered alone = cover(camera_scene(isovelocity_water + flat_sand)),
                near = cover(camera_scene(isovelocity_water + flat_sand, "receiver_arm_m = [0, 0, 1e-6]\n"));
  // The difference is due to the corners of the polygons of the range gate, which have another start.
  expect_near(near, alone, 1e-4);
}

TEST_F(CoverageLooks, NeitherThreadsNorWaterThatHardlyRefractsChangeIt) {
  for (const std::string& sensor : {std::string(), arms(one, other)}) {
    SCOPED_TRACE(sensor);
    const Covered straight = cover(camera_scene(isovelocity_water + flat_sand, sensor)),
                  refracted = cover(camera_scene(water(gentle) + flat_sand, sensor), {"--threads", "1"});
    expect_near(refracted, straight, 1e-5);
    EXPECT_EQ(cover(camera_scene(water(gentle) + flat_sand, sensor), {"--threads", "3"}).table,
              refracted.table);
    const Covered more = cover(camera_scene(water(steep) + flat_sand, sensor));
    EXPECT_GT(std::abs(more.seen_m2 - straight.seen_m2), 1e-4) << "this does";
  }
}

TEST_F(CoverageLooks, ReliefOfEachTransmissionIsThatOfReliefOnce) {
  const Covered flat = cover(camera_scene(isovelocity_water + flat_sand));
  expect_near(cover(camera_scene(isovelocity_water + ripples(1e-6, "online"))), flat, 1e-4);
  // With a tolerance of 0 the cells of each transmission are those of a single refinement. The coverage of
  // the same facets refers to the unrefined facets or to the cells. Areas are those of small slopes.
  const Covered online = cover(camera_scene(isovelocity_water + ripples(0.03, "online"))),
                offline = cover(camera_scene(isovelocity_water + ripples(0.03, "offline")));
  EXPECT_LT(online.seen.size(), 20u);
  EXPECT_GT(offline.seen.size(), 400u);
  EXPECT_NEAR(online.seen_m2, offline.seen_m2, 0.015 * online.seen_m2);
  EXPECT_NEAR(online.shadow_m2, offline.shadow_m2, 0.015 * online.shadow_m2);
  EXPECT_GT(std::abs(online.shadow_m2 - flat.shadow_m2), 1e-3 * flat.shadow_m2) << "ripples throw shadows";
}

// On a coarse grid the range gate ends after few grid units.
TEST_F(CoverageLooks, TheRangeGateNeedsNoFineGrid) {
  const auto on_grid = [&](int exponent) {
    return cover(
        camera_scene(fmt::format("[run]\ngrid_exponent = {}\n", exponent) + isovelocity_water + flat_sand));
  };
  const Covered fine = on_grid(16), coarse = on_grid(9);
  EXPECT_NEAR(coarse.seen_m2, fine.seen_m2, 0.01 * fine.seen_m2);
  EXPECT_NEAR(coarse.shadow_m2, fine.shadow_m2, 0.01 * fine.shadow_m2);
}

TEST_F(CoverageLooks, AllAtOnceCloses) {
  const std::string all = camera_scene(water(steep) + ripples(0.02, "online"), arms(one, other));
  const Covered first = cover(all, {"--threads", "1"});
  EXPECT_EQ(cover(all, {"--threads", "4"}).table, first.table);
}

}  // namespace
}  // namespace tubefoot
