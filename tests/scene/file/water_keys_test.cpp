// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the keys of the water: isovelocity water, profiles from tables, casts and formulas, and errors in
// their files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/water/absorption.hpp"
#include "engine/water/sound_speed.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "scene/scene_water.hpp"

namespace tubefoot {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

std::string scene_with_water(const std::string& lines) {
  return std::string(smallest_scene) + "[water]\n" + lines;
}

class WaterKeys : public testing::Test {
 protected:
  SceneWater water(const std::string& lines) {
    return SceneWater(read_scene(folder_, scene_with_water(lines)).water);
  }
  std::string error_of(const std::string& lines) { return scene_error(folder_, scene_with_water(lines)); }
  /// The error of loading the water from a file "p.csv".
  std::string file_error(const std::string& profile, const std::string& csv) {
    const auto file = folder_.write("p.csv", csv);
    try {
      water("profile = \"" + profile + "\"\nprofile_file = \"p.csv\"\n");
    } catch (const InputError& error) {
      return std::string(error.what()).substr(file.string().size() - 5);
    }
    return {};
  }
  TestFolder folder_;
};

TEST_F(WaterKeys, IsovelocityWaterIsAsItWas) {
  EXPECT_FALSE(water("").refracts());
  EXPECT_EQ(water("").profile().at(50), mackenzie_sound_speed_m_s(10, 35, 10));
  EXPECT_EQ(water("sound_speed_m_s = 1480").profile().at(50), 1480);
  const WaterColumn column = water("ph = 7.9").column(240);
  for (const double alpha : column.absorption_db_per_m)
    EXPECT_EQ(alpha, francois_garrison_absorption_db_per_km(240, 10, 35, 10, 7.9) / 1000);
  EXPECT_EQ(water("sound_speed_formula = \"leroy\"\nlatitude_deg = 60\ndepth_m = 500").profile().at(0),
            leroy_sound_speed_m_s(10, 35, 500, 60));
  EXPECT_EQ(water("absorption_model = \"ainslie-mccolm\"").column(100).absorption_db_per_m[0],
            ainslie_mccolm_absorption_db_per_km(100, 10, 35, 10, 8) / 1000);
}

TEST_F(WaterKeys, Table) {
  folder_.write("p.csv",
                "# deep first column\nsound_speed_m_s, note, depth_m\n1500,a,0\n\n1490,b,20\n1495,c,60\n");
  const SceneWater w = water("profile = \"table\"\nprofile_file = \"p.csv\"\nsurface_height_m = 3");
  EXPECT_TRUE(w.refracts());
  EXPECT_EQ(w.surface_height_m(), 3);
  ASSERT_EQ(w.profile().points().size(), 3u);
  EXPECT_EQ(w.profile().at(10), 1495);
  EXPECT_EQ(w.profile().at(100), 1495);
  // Layers from 0 to 20 and 20 to 60 m, and beyond: absorption at their middles.
  const auto alpha = w.column(300).absorption_db_per_m;
  const double depths[] = {0, 10, 40, 60};
  ASSERT_EQ(alpha.size(), 4u);
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(alpha[i], francois_garrison_absorption_db_per_km(300, 10, 35, depths[i], 8) / 1000);
}

TEST_F(WaterKeys, Cast) {
  folder_.write("p.csv", "depth_m,temperature_c,salinity_psu\n0,18,34\n10,17,34.5\n50,9,35.5\n");
  const std::string lines = "profile = \"cast\"\nprofile_file = \"p.csv\"\n";
  const SceneWater w = water(lines);
  EXPECT_EQ(w.profile().points()[2].sound_speed_m_s, mackenzie_sound_speed_m_s(9, 35.5, 50));
  EXPECT_EQ(w.column(300).absorption_db_per_m[2],
            francois_garrison_absorption_db_per_km(300, 13, 35, 30, 8) / 1000);
  EXPECT_EQ(w.column(300).absorption_db_per_m[0],
            francois_garrison_absorption_db_per_km(300, 18, 34, 0, 8) / 1000);
  EXPECT_EQ(water(lines + "absorption_db_per_km = 70").column(300).absorption_db_per_m[1], 0.07);
  EXPECT_EQ(water(lines + "sound_speed_formula = \"leroy\"\nlatitude_deg = 60").profile().at(50),
            leroy_sound_speed_m_s(9, 35.5, 50, 60));
}

TEST_F(WaterKeys, Formulas) {
  const SceneWater line =
      water("profile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = -0.2\nprofile_bottom_m = 50");
  EXPECT_NEAR(line.profile().at(25), 1495, 1e-12);
  EXPECT_NEAR(line.profile().at(80), 1490, 1e-12);
  const SceneWater munk = water("profile = \"munk\"\nsound_speed_m_s = 1500\nprofile_bottom_m = 5000");
  for (double z = 0; z < 5000; z += 37) EXPECT_NEAR(munk.profile().at(z), munk_sound_speed_m_s(z), 0.01);
  EXPECT_EQ(water("profile = \"munk\"\nsound_speed_m_s = 1490\nprofile_bottom_m = 800\nmunk_axis_m = 400\n"
                  "munk_scale_m = 500\nmunk_epsilon = 0.01\nprofile_step_m = 8")
                .profile()
                .at(80),
            munk_sound_speed_m_s(80, 1490, 400, 500, 0.01));
  const SceneWater n2 = water(
      "profile = \"n2-linear\"\nsound_speed_m_s = 1550\ngradient_per_s = 1.2\nprofile_bottom_m = 1000\n"
      "profile_error_m_s = 0.001");
  EXPECT_NEAR(n2.profile().at(333), n2_linear_sound_speed_m_s(333, 1550, 1.2), 0.001);
}

TEST_F(WaterKeys, KeysThatDoNotFitTogether) {
  EXPECT_THAT(error_of("profile = \"table\""), HasSubstr("13:11: profile = \"table\" needs 'profile_file'"));
  EXPECT_THAT(error_of("gradient_per_s = 1"),
              HasSubstr("belongs to profile = \"gradient\" or \"n2-linear\""));
  EXPECT_THAT(error_of("surface_height_m = 1"), HasSubstr("but the profile is \"constant\""));
  EXPECT_THAT(error_of("profile = \"munk\"\nprofile_bottom_m = 5"), HasSubstr("the speed at its axis"));
  EXPECT_THAT(error_of("latitude_deg = 5"), HasSubstr("sound_speed_formula = \"leroy\""));
  EXPECT_THAT(
      error_of("profile = \"munk\"\nsound_speed_m_s = 1500\nprofile_bottom_m = 50\nprofile_step_m = 1\n"
               "profile_error_m_s = 1"),
      HasSubstr("give only one of the two"));
  folder_.write("p.csv", "");
  EXPECT_THAT(error_of("profile = \"table\"\nprofile_file = \"p.csv\"\nsound_speed_m_s = 1500"),
              HasSubstr("15:19"));
  EXPECT_THAT(error_of("profile = \"cast\"\nprofile_file = \"missing.csv\""), HasSubstr("missing.csv"));
  EXPECT_THROW(water("profile = \"n2-linear\"\nsound_speed_m_s = 1550\ngradient_per_s = -1\n"
                     "profile_bottom_m = 2000\nprofile_step_m = 10"),
               InputError);
  EXPECT_THROW(water("profile = \"gradient\"\nsound_speed_m_s = 1550\ngradient_per_s = -10\n"
                     "profile_bottom_m = 200"),
               InputError);
}

TEST_F(WaterKeys, FilesAreRefusedAtTheirPlace) {
  const std::string head = "depth_m,sound_speed_m_s\n";
  EXPECT_THAT(file_error("table", ""), StartsWith("p.csv: is empty"));
  EXPECT_THAT(file_error("table", head), StartsWith("p.csv: has a header but no rows"));
  EXPECT_THAT(file_error("table", "depth_m,speed\n"), StartsWith("p.csv:1: the column sound_speed_m_s"));
  EXPECT_THAT(file_error("table", "Depth,sound_speed_m_s\n"),
              EndsWith("'Depth' holds it, rename that column to depth_m"));
  EXPECT_THAT(file_error("table", head + "0,1500\n5, x\n"), StartsWith("p.csv:3:4: sound_speed_m_s is 'x'"));
  EXPECT_THAT(file_error("table", head + "0,1500\n0,1501\n"),
              StartsWith("p.csv:3:1: depth_m must increase: 0 follows 0"));
  EXPECT_THAT(file_error("table", head + "0,150\n"),
              StartsWith("p.csv:2:3: sound_speed_m_s is 150, expected"));
  EXPECT_THAT(file_error("table", head + "0,1500,2\n"), StartsWith("p.csv:2: the row has 3 fields"));
  EXPECT_THAT(file_error("table", head + "nan,1500\n"), StartsWith("p.csv:2:1: depth_m is 'nan'"));
  const std::string cast = "depth_m,temperature_c,salinity_psu\n";
  EXPECT_THAT(file_error("cast", cast + "0,10,20\n"), StartsWith("p.csv:2:6: salinity_psu is 20"));
  EXPECT_THAT(file_error("cast", cast + "0,50,35\n"), StartsWith("p.csv:2:3: temperature_c is 50"));
}

}  // namespace
}  // namespace tubefoot
