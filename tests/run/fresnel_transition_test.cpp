// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the width of the Fresnel transition at shadow borders: values of the formula, and a plate below a
// sonar.
#include "run/fresnel_transition.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using testing::Not;

// A DIDSON at 1.8 MHz, 5 m and 1.5 m, grazing angle of 15 degrees: 11.0 cm. A RESON 8101 at 240 kHz, 30 m
// and 5 m, 45 degrees: 19 cm.
TEST(FresnelTransition, OfKnownSonars) {
  const double degree_rad = std::acos(-1) / 180;
  EXPECT_NEAR(fresnel_width_m(5, 1.5, 1500 / 1.8e6) / std::sin(15 * degree_rad), 0.110, 5e-4);
  EXPECT_NEAR(fresnel_width_m(30, 5, 1500 / 240e3) / std::sin(45 * degree_rad), 0.191, 5e-4);
  // The Fresnel parameter is 1 at this distance.
  const double h = fresnel_width_m(7, 2, 0.01);
  EXPECT_NEAR(h * std::sqrt(2 * 7 / (0.01 * 2 * 9)), 1, 1e-14);
}

std::string scene_below_sonar(const std::string& object) {
  return lambert_material("rock", -10) + flat_terrain(60, 60) + object +
         "[trajectory]\nkind = \"line\"\nstart_m = [0, 0, 10]\nend_m = [0.5, 0, 10]\nspeed_m_s = 0.5\n"
         "[[sensors]]\nname = \"down\"\nkind = \"imaging\"\nfrequency_khz = 300\ntilt_deg = 90\nbeams = 12\n"
         "horizontal_deg = 40\nvertical_deg = 40\nrange_max_m = 14\nsamples = 100\npings = 5\n"
         "ping_interval_s = 0.2\n";
}

TEST(FresnelTransition, OfAPlateBelowASonarIsInCheckAndStatistics) {
  const TestFolder folder;
  const std::string plate =
      "[[objects]]\nname = \"plate\"\nshape = \"box\"\nsize_m = [1, 1, 0.01]\nposition_m = [0.2, 0, 4]\n";
  const std::string file = folder.write("scene.toml", scene_below_sonar(plate)).string();
  const Outcome run = run_program({"run", file, "-o", (folder / "out").string(), "--quiet"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto stats = nlohmann::json::parse(std::ifstream(folder / "out/stats.json"));
  const auto& of_sensor = stats.at("fresnel_transition").at("down");
  EXPECT_EQ(of_sensor.at("pings"), 3);
  // At each of the three pings the shadow of the square has a perimeter of 4 m times 10 / 6.
  EXPECT_NEAR(of_sensor.at("shadow_borders_m").get<double>(), 3 * 4 * 10.0 / 6, 0.05);
  // Edges are nearly below the sonar, at 6 m, and their shadows 4 m beyond.
  const double width_m = std::sqrt(0.005 * 4 * 10 / (2 * 6));
  EXPECT_NEAR(of_sensor.at("width_m_median").get<double>(), width_m, 0.02 * width_m);
  EXPECT_LE(of_sensor.at("width_m_percentile_5"), of_sensor.at("width_m_median"));
  EXPECT_LE(of_sensor.at("width_m_median"), of_sensor.at("width_m_percentile_95"));
  const Outcome check = run_program({"check", file});
  ASSERT_EQ(check.exit_code, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("Fresnel transition 0.13 m wide on the surface (0.13 to 0.13 m), on 20 m "
                                   "of shadow borders of 3 pings"));
}

TEST(FresnelTransition, IsAbsentWithoutShadows) {
  const TestFolder folder;
  const std::string file = folder.write("scene.toml", scene_below_sonar("")).string();
  ASSERT_EQ(run_program({"run", file, "-o", (folder / "out").string(), "--quiet"}).exit_code, 0);
  EXPECT_FALSE(
      nlohmann::json::parse(std::ifstream(folder / "out/stats.json")).contains("fresnel_transition"));
  EXPECT_THAT(run_program({"check", file}).out, Not(HasSubstr("Fresnel")));
}

}  // namespace
}  // namespace tubefoot
